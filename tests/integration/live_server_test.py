# SPDX-License-Identifier: Apache-2.0
"""A station as its pages see it: who may come in, who moves the part, what is refused, and that a hand that is gone lets go.
The socket is spoken by hand, so that it can be spoken badly."""

import base64
import http.client
import json
import os
import signal
import socket
import struct
import subprocess
import sys
import time
import unittest
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "support"))
from drivers import PEG, DriverTest

PROTOCOL = "aussois.live.1"
FRAME = struct.Struct("<HHIQ dqIIff3f3f3f3fIIIIQq")
FRAME_NAMES = ("kind version bytes sequence t moment take flags slow distance ax ay az bx by bz px py pz qx qy qz bodies "
               "contacts all_contacts spare skipped ends").split()
HELD, PAUSED = 1, 2


def command(mode=0, values=(0, 0, 0, 0, 0, 0, 1), grip=(0, 0, 0), drawn=0):
    return struct.pack("<HHIQIIQ7d3dQ", 2, 1, 120, 0, mode, 1, drawn, *values, *grip, 0)


class Page:
    """One WebSocket."""

    def __init__(self, port, origin=None, protocol=PROTOCOL, host=None, path="/live"):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=60)
        at = f"127.0.0.1:{port}"
        self.socket.sendall((f"GET {path} HTTP/1.1\r\nHost: {host or at}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             f"Sec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\nSec-WebSocket-Version: 13\r\n"
                             f"Origin: {origin or 'http://' + at}\r\nSec-WebSocket-Protocol: {protocol}\r\n\r\n").encode())
        head = b""
        while not head.endswith(b"\r\n\r\n"):
            byte = self.socket.recv(1)
            if not byte:
                break
            head += byte
        self.status = int(head.split()[1]) if head else 0
        self.frame, self.texts, self.closed, self.meshes = None, [], None, 0

    def send(self, message):
        opcode, data = (1, json.dumps(message).encode()) if isinstance(message, (dict, list)) else \
            (1, message.encode()) if isinstance(message, str) else (2, message)
        size = bytes([0x80 | len(data)]) if len(data) < 126 else bytes([0x80 | 126]) + struct.pack(">H", len(data)) if len(data) < 65536 \
            else bytes([0x80 | 127]) + struct.pack(">Q", len(data))
        self.socket.sendall(bytes([0x80 | opcode]) + size + bytes(4) + data)

    def _read(self, n):
        data = b""
        while len(data) < n:
            more = self.socket.recv(n - len(data))
            if not more:
                raise ConnectionError
            data += more
        return data

    def take(self):
        """Takes one message."""
        try:
            first, size = self._read(2)
            size = struct.unpack(">H", self._read(2))[0] if size == 126 else struct.unpack(">Q", self._read(8))[0] if size == 127 else size
            data = self._read(size)
        except (ConnectionError, OSError):
            self.closed = self.closed or (1006, "")
            return
        opcode = first & 15
        if opcode == 1:
            self.texts.append(json.loads(data))
        elif opcode == 8:
            self.closed = (struct.unpack(">H", data[:2])[0], data[2:].decode()) if data else (1005, "")
        elif opcode == 2 and data[0] == 3:
            self.meshes += 1
        elif opcode == 2:
            self.frame = dict(zip(FRAME_NAMES, FRAME.unpack_from(data)))
            self.poses = [struct.unpack_from("<7f", data, 128 + 28 * i) for i in range(self.frame["bodies"])]

    def until(self, fact, say=None, seconds=90):
        """Takes messages until the fact holds; says `say()` after each frame."""
        end = time.monotonic() + seconds
        while not fact():
            if time.monotonic() > end or self.closed:
                raise AssertionError(f"not within {seconds} s; closed {self.closed}, frame {self.frame}, last {self.texts[-2:]}")
            before = self.frame
            self.take()
            if self.frame is not before and not self.closed:
                self.send(say() if say else command(drawn=self.frame["sequence"]))
        return self

    def text(self, kind):
        self.until(lambda: any(t["kind"] == kind for t in self.texts))
        return next(t for t in reversed(self.texts) if t["kind"] == kind)


class LiveServer(DriverTest):
    def setUp(self):
        super().setUp()
        self.process = subprocess.Popen([Path(os.environ["AUSSOIS_DRIVERS"], "assembly_station"), *map(str, PEG), "--quiet", "--threads", "1", "-o", "out"],
                                        cwd=self.folder, stdout=subprocess.PIPE, stderr=open(self.folder / "stderr", "w"), text=True)
        self.addCleanup(self.end)
        address = self.process.stdout.readline().strip()
        self.assertRegex(address, r"^http://127\.0\.0\.1:\d+/#[0-9a-f]{32}$")
        self.port, self.token = int(address.split(":")[2].split("/")[0]), address.split("#")[1]

    def end(self):
        self.process.kill()
        self.process.communicate()
        self.assertNotRegex((self.folder / "stderr").read_text(), "Sanitizer|runtime error:")

    def page(self, role="controller", **hello):
        page = Page(self.port)
        self.assertEqual(page.status, 101)
        page.send({"kind": "hello", "token": self.token, "role": role, **hello})
        page.text("welcome")
        self.assertEqual(page.text("role")["role"], role)
        return page.until(lambda: page.frame)

    def grab(self, page, shift=(0, 0, 0)):
        """Says that a hand holds the part where it is, off by a shift."""
        moving = page.text("welcome")["moving"]
        x, y, z, *q = page.poses[moving]
        values = (x + shift[0], y + shift[1], z + shift[2], *q)
        return lambda: command(1, values, drawn=page.frame["sequence"])

    def request(self, method="GET", path="/", **headers):
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=30)
        connection.putrequest(method, path, skip_host="Host" in headers, skip_accept_encoding=True)
        for name, value in headers.items():
            connection.putheader(name, value)
        connection.endheaders()
        return connection.getresponse()

    def test_lets_in_whom_it_should(self):
        response = self.request()
        self.assertEqual(response.status, 200)
        policy = response.getheader("Content-Security-Policy")
        self.assertIn("default-src 'none'", policy)
        self.assertNotIn("unsafe", policy)
        self.assertEqual(response.getheader("Cache-Control"), "no-store")
        for path in ("/live.js", "/live.css", "/live_worker.js"):
            self.assertEqual(self.request(path=path).status, 200)
        for path in ("/../../etc/passwd", "/%2e%2e/%2e%2e/etc/passwd", "/live.js?x", "//live.js", "/favicon.ico"):
            self.assertEqual(self.request(path=path).status, 404)
        self.assertEqual(self.request(Host="example.org").status, 421)
        self.assertEqual(self.request("POST").status, 405)
        self.assertEqual(Page(self.port, origin="http://example.org").status, 403)
        self.assertEqual(Page(self.port, origin="null").status, 403)
        self.assertEqual(Page(self.port, protocol="chat").status, 400)
        self.assertEqual(Page(self.port, host="example.org").status, 421)
        self.assertEqual(Page(self.port, path="/other").status, 404)

    def closes(self, *messages, hello=True):
        page = self.page() if hello else Page(self.port)
        for message in messages:
            page.send(message)
        end = time.monotonic() + 30
        while not page.closed and time.monotonic() < end:
            page.take()
        self.assertIsNotNone(page.closed)
        return page.closed

    def test_closes_where_it_is_not_understood(self):
        self.assertEqual(self.closes({"kind": "hello", "token": "0" * 32}, hello=False), (1008, "wrong token"))
        self.assertEqual(self.closes({"kind": "set"}, hello=False)[0], 1008)
        self.assertEqual(self.closes({"kind": 1}, hello=False)[0], 1008)
        self.assertEqual(self.closes({"kind": "hello", "token": [self.token]}, hello=False)[0], 1008)
        self.page()  # it lives
        self.assertEqual(self.closes(command(), hello=False)[0], 1008)
        self.page()  # a right one: the count of wrong ones begins anew
        self.assertIn("bytes = 119", self.closes(command()[:-1])[1])
        deep = self.page()
        deep.send("[" * 10000)  # no object
        while not deep.closed:
            deep.take()
        self.assertIn("version = 2", self.closes(command()[:2] + b"\2\0" + command()[4:])[1])
        self.assertIn("target", self.closes(command(1, (float("nan"), 0, 0, 0, 0, 0, 1)))[1])
        self.assertIn("JSON object", self.closes("[1, 2]")[1])
        self.assertIn("JSON object", self.closes("{")[1])
        self.assertIn(self.closes("x" * 100000)[0], (1006, 1009))
        self.assertIn("500 messages", self.closes(*600 * [command()])[1])
        self.assertIsNone(self.process.poll())

    def test_shuts_the_door_after_three_wrong_tokens(self):
        for _ in range(3):
            self.closes({"kind": "hello", "token": "f" * 32}, hello=False)
        self.assertIn("wait ten seconds", self.closes({"kind": "hello", "token": "f" * 32}, hello=False)[1])
        self.page()  # nobody can lock the engineer out

    def test_sends_away_who_says_nothing(self):
        silent = [Page(self.port) for _ in range(40)]
        self.assertEqual({page.status for page in silent[:32]}, {101})
        self.assertEqual({page.status for page in silent[32:]}, {503})
        while not silent[0].closed:
            silent[0].take()
        self.assertIn("no hello", silent[0].closed[1])

    def test_has_one_hand(self):
        page, viewer = self.page(), self.page("viewer")
        self.assertEqual(page.meshes, 2)
        say = self.grab(page, (0, 0, 0.002))
        page.until(lambda: page.frame["flags"] & HELD, say)
        x = page.frame["moment"]
        viewer.until(lambda: viewer.frame["moment"] > x + 100, lambda: command(2, (1, 1, 1, 0, 0, 0, 0), drawn=viewer.frame["sequence"]))
        viewer.send({"kind": "set", "name": "mu", "value": 0.3})
        self.assertIn("only watches", viewer.text("refused")["why"])
        viewer.send({"kind": "take_control"})
        self.assertEqual(page.text("control_asked")["seconds"], 5)
        page.send({"kind": "keep_control"})
        viewer.texts.clear()
        self.assertIn("keeps it", viewer.text("refused")["why"])
        page.send({"kind": "release"})
        page.until(lambda: not page.frame["flags"] & HELD)
        viewer.send({"kind": "take_control"})
        viewer.until(lambda: any(t["kind"] == "role" and t["role"] == "controller" for t in viewer.texts))

    def test_lets_go_when_the_hand_is_gone(self):
        page, viewer = self.page(), self.page("viewer")
        page.until(lambda: page.frame["flags"] & HELD, self.grab(page, (0, 0, 0.002)))
        page.socket.close()
        viewer.until(lambda: viewer.frame["flags"] & HELD == 0)
        silent = self.page()
        silent.until(lambda: silent.frame["flags"] & HELD, self.grab(silent))
        begin = time.monotonic()
        viewer.until(lambda: not viewer.frame["flags"] & HELD)  # it says nothing more
        self.assertLess(time.monotonic() - begin, 20)

    def test_goes_back_and_begins_a_take(self):
        page = self.page()
        lift = self.grab(page, (0, 0, 0.003))
        page.until(lambda: page.frame["moment"] > 150, lift)
        page.send({"kind": "mark", "text": "here"})
        self.assertEqual(page.text("event")["text"], "here")
        page.send({"kind": "seek", "take": 0, "moment": 100})
        page.until(lambda: page.frame["flags"] & PAUSED and page.frame["moment"] == 100, lift)
        page.until(lambda: page.frame["flags"] & PAUSED)
        page.send({"kind": "pause", "on": False})
        page.until(lambda: page.frame["take"] == 1 and page.frame["moment"] > 110)
        page.send({"kind": "set", "name": "mu", "value": 0.0})
        page.until(lambda: any(p["name"] == "mu" and p["value"] == 0 for t in page.texts if t["kind"] == "parameters" for p in t["parameters"]))
        for wrong, why in (({"kind": "seek", "take": 7, "moment": 0}, "take = 7"), ({"kind": "seek", "take": 0, "moment": -1}, "moment = -1"),
                           ({"kind": "set", "name": "mu", "value": "0"}, "must be a number"), ({"kind": "set", "name": "restitution", "value": 1e308}, "restitution"),
                           ({"kind": "mark", "text": "x" * 1001}, "1001"), ({"kind": "dance"}, "dance"),
                           ({"kind": "pause", "on": True, "off": 1}, "'off' is unknown")):
            with self.subTest(why):
                page.texts.clear()
                page.send(wrong)
                self.assertIn(why, page.text("refused")["why"])
        page.texts.clear()
        page.send({"kind": "save"})
        self.assertIn("session.h5", page.text("saved")["text"])
        self.process.send_signal(signal.SIGINT)
        self.assertEqual(self.process.wait(120), 0)
        again = self.drive("assess_path", "--session", "out/session.h5", "--quiet", "--threads", 1, "-o", "again")
        self.assertEqual(again.returncode, 0, again.stderr)
        self.assertIn("hashes the same", again.stdout)

    def test_is_said_to_stop(self):
        page = self.page()
        page.send({"kind": "stop"})
        self.assertEqual(page.text("closing")["why"], "the station ends")
        self.assertEqual(self.process.wait(120), 0)


if __name__ == "__main__":
    unittest.main()
