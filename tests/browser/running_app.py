"""The server of the page in a process of its own."""

import re
import signal
import subprocess
import sys


class App:
    """A running ``asperity app``: its address, process, and folder."""

    def __init__(self, folder, *arguments):
        self.folder = folder
        command = [sys.executable, "-m", "asperity", "app", "--no-browser", *map(str, arguments)]
        self.process = subprocess.Popen(command, cwd=folder, stdout=subprocess.PIPE, text=True)
        self.address = self.process.stdout.readline().strip()
        self.port = int(re.search(r":(\d+)/", self.address)[1])

    def close(self):
        """End it as Ctrl-C does."""
        self.process.send_signal(signal.SIGINT)
        self.process.wait(20)
        self.process.stdout.close()
