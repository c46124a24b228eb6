from asperity.runtime.preflight import claim, require_memory, require_space, require_undamaged


onstart:
    jobs = list(workflow.dag.needrun_jobs())
    try:
        CLAIM = claim(RESULTS)
        if workflow.local_exec:
            limit = workflow.global_resources.get("mem_mb")
            require_memory(needs(jobs, "mem_mb"), limit and limit.value)
        require_space(RESULTS, sum(needs(jobs, "disk_mb").values()))
        require_undamaged(earlier_results(jobs))
    except PreflightError as error:
        sys.exit(f"study: {error}")
    announce_run(jobs)


onerror:
    sys.exit("\n".join(f"study: {last_words(job)}" for job in sorted(workflow.scheduler.failed, key=str)))
