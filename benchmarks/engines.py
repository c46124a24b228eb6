"""Processor time of a contact and of its stress with each engine of the Fourier transforms."""

import time

import asperity as asp
from asperity.fourier import ENGINES

NODES, RUNS = 1024, 3

if __name__ == "__main__":
    height = asp.self_affine((NODES, NODES), 0.8, 1e-4, 4e-6, rms_height=1e-7, seed=1, length=2e-4)
    least = {}
    for _ in range(RUNS):
        for engine in ENGINES:
            with asp.fft_engine(engine):
                begin = time.process_time()
                contact = asp.solve_contact(height, asp.Solid(210e9, 0.3), 2e-4, mean_pressure=50e6)
                middle = time.process_time()
                asp.analyse_stress(contact)
            seconds = middle - begin, time.process_time() - middle
            least[engine] = tuple(map(min, least.get(engine, seconds), seconds))
    for engine, (contact_seconds, stress_seconds) in least.items():
        print(f"{engine:<8}contact {contact_seconds:.3f} s, stress {stress_seconds:.3f} s")
