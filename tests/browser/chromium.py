"""Headless Chromium driven through its debugging pipe: pages opened, scripts run, keys pressed, pictures taken.

Only Python's own library: the DevTools protocol speaks JSON, ended by a zero byte, on two file descriptors, so no port is opened.
"""
import base64
import json
import os
import pathlib
import subprocess
import tempfile


class Chromium:
    """A browser with one page. Console messages of level error or warning, and uncaught exceptions, gather in `complaints`."""

    def __init__(self, *options):
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        read_commands, self._write = os.pipe()
        self._read, write_answers = os.pipe()

        def hand_over():
            # high numbers first: a pipe may itself have got 3 or 4
            commands, answers = os.dup(read_commands), os.dup(write_answers)
            os.dup2(commands, 3)
            os.dup2(answers, 4)

        self._process = subprocess.Popen(
            ["chromium", "--headless", "--no-sandbox", "--remote-debugging-pipe", "--no-first-run", "--disable-background-networking",
             "--disable-component-update", "--disable-sync", "--hide-scrollbars", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
             "--disable-dev-shm-usage", f"--user-data-dir={self._profile.name}", *options, "about:blank"],
            pass_fds=(3, 4), preexec_fn=hand_over, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(read_commands)
        os.close(write_answers)
        self._answers, self._number, self._session = b"", 0, None
        self.complaints, self._events = [], []
        targets = self.send("Target.getTargets")["targetInfos"]
        page = next(t for t in targets if t["type"] == "page")
        self._session = self.send("Target.attachToTarget", targetId=page["targetId"], flatten=True)["sessionId"]
        for domain in ("Page", "Runtime", "Log"):
            self.send(domain + ".enable")

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._process.kill()
        self._process.wait()
        os.close(self._write)
        os.close(self._read)
        self._profile.cleanup()

    def _next(self):
        while b"\0" not in self._answers:
            more = os.read(self._read, 1 << 20)
            assert more, "Chromium ended"
            self._answers += more
        text, self._answers = self._answers.split(b"\0", 1)
        return json.loads(text)

    def _note(self, event):
        method, params = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            details = params["exceptionDetails"]
            self.complaints.append(details.get("exception", {}).get("description", details["text"]))
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning", "assert"):
            self.complaints.append(" ".join(str(a.get("value", a.get("description"))) for a in params["args"]))
        elif method == "Log.entryAdded" and params["entry"]["level"] in ("error", "warning"):
            # the browser's own remark that it renders without a graphics card is none of the page's
            if "GPU stall" not in params["entry"]["text"]:
                self.complaints.append(params["entry"]["text"])
        elif method:
            self._events.append(method)

    def send(self, method, **params):
        self._number += 1
        message = {"id": self._number, "method": method, "params": params}
        if self._session:
            message["sessionId"] = self._session
        os.write(self._write, json.dumps(message).encode() + b"\0")
        while True:
            answer = self._next()
            if answer.get("id") == self._number:
                assert "error" not in answer, f"{method}: {answer.get('error')}"
                return answer["result"]
            self._note(answer)

    def size(self, width, height, phone=False):
        self.send("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=2 if phone else 1, mobile=phone)
        self.send("Emulation.setTouchEmulationEnabled", enabled=phone)

    def open(self, path):
        self._events.clear()
        self.send("Page.navigate", url=pathlib.Path(path).absolute().as_uri())
        while "Page.loadEventFired" not in self._events:
            self._note(self._next())
        self.settle()

    def settle(self):
        """Until the page has drawn what it asked to draw."""
        self.run("new Promise(done => requestAnimationFrame(() => requestAnimationFrame(() => setTimeout(done, 50))))")

    def run(self, script):
        """Value of an expression in the page; promises are awaited."""
        answer = self.send("Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True)
        assert "exceptionDetails" not in answer, answer["exceptionDetails"].get("exception", answer["exceptionDetails"])
        return answer["result"].get("value")

    def key(self, key, code=None, number=0, text=None, modifiers=0):
        common = {"key": key, "code": code or key, "windowsVirtualKeyCode": number, "modifiers": modifiers}
        self.send("Input.dispatchKeyEvent", type="keyDown" if text else "rawKeyDown", **common, **({"text": text} if text else {}))
        self.send("Input.dispatchKeyEvent", type="keyUp", **common)

    def picture(self, path, whole=True):
        """A PNG of the window, or of the whole page: in parts of 8000 px, `name_2.png` and on, since a surface ends at 8192."""
        path = pathlib.Path(path)
        if not whole:
            path.write_bytes(base64.b64decode(self.send("Page.captureScreenshot", format="png")["data"]))
            return
        size = self.send("Page.getLayoutMetrics")["cssContentSize"]
        for part, top in enumerate(range(0, int(size["height"]), 8000)):
            clip = {"x": 0, "y": top, "width": size["width"], "height": min(size["height"] - top, 8000), "scale": 1}
            data = self.send("Page.captureScreenshot", format="png", captureBeyondViewport=True, clip=clip)["data"]
            (path if part == 0 else path.with_stem(f"{path.stem}_{part + 1}")).write_bytes(base64.b64decode(data))

    def paper(self, path):
        data = self.send("Page.printToPDF", printBackground=False, preferCSSPageSize=True, paperWidth=8.27, paperHeight=11.69)["data"]
        pathlib.Path(path).write_bytes(base64.b64decode(data))
