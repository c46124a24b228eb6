"""The server of the page in a process of its own."""

import http.client
import os
import re
import signal
import subprocess
import sys
from functools import cached_property


class App:
    """A running ``asperity app``: its process, folder, page, and an address that has not been opened."""

    def __init__(self, folder, *arguments, **environment):
        self.folder = folder
        self.is_shown = "BROWSER" in environment
        hidden = [] if self.is_shown else ["--no-browser"]
        command = [sys.executable, "-m", "asperity", "app", *hidden, *map(str, arguments)]
        self.process = subprocess.Popen(
            command, cwd=folder, stdout=subprocess.PIPE, text=True, env=os.environ | environment
        )
        self.next_address()
        self.port = int(re.search(r":(\d+)/", self.address)[1])
        self.page = self.address.rpartition("once-")[0]
        self.path = "/" + self.page.split("/", 3)[3]

    def next_address(self):
        """Read the address that is printed at the start, and again once it is opened."""
        line = "\n"
        while line and not line.startswith("http"):
            line = self.process.stdout.readline()
        self.address = line.split()[0]

    @cached_property
    def cookie(self):
        """The cookie that a browser gets when it opens an address."""
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=20)
        connection.request("GET", self.path + self.address.rpartition("/")[2])
        reply = connection.getresponse()
        reply.read()
        connection.close()
        assert (reply.status, reply.headers["Location"]) == (302, "./")
        if not self.is_shown:  # else the address that the browser got can still be opened
            self.next_address()
        return reply.headers["Set-Cookie"].partition(";")[0]

    def close(self):
        """End it as Ctrl-C does."""
        self.process.send_signal(signal.SIGINT)
        self.process.wait(20)
        self.process.stdout.close()
