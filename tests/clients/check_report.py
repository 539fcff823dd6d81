#!/usr/bin/env python3
"""Opens a report in headless Chromium as its readers do, and touches everything in it.

usage: check_report.py REPORT.html [SCREENSHOTS_FOLDER]

At 1440 x 900 and on a phone of 390 x 844 pixels: no error on the console, no request to anywhere, every control works,
every colour and cut gives another picture, links of failed rows show their part, words explain themselves. On the phone
also: the page's length, pinching, and that a finger on the heart still scrolls the page. Needs Debian's `chromium`; it
speaks the DevTools protocol through a pipe, so that nothing else is needed. Exit 1 and a line for everything amiss.
"""
import base64
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import time

SIZES = {"desktop": (1440, 900), "phone": (390, 844)}
LONGEST_PHONE_PAGE_PX = 4300
LARGEST_PAGE_BYTES = 25e6
HIGHEST_PICTURE_PX = 8000


class Browser:
    """A Chromium of its own; commands and events are JSON texts that end with a zero byte."""

    def __init__(self, profile):
        to_read, self.write_end = os.pipe()
        self.read_end, to_write = os.pipe()
        command = [shutil.which("chromium"), "--headless=new", "--remote-debugging-pipe", "--no-sandbox",
                   "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
                   "--user-data-dir=" + profile, "--force-prefers-reduced-motion", "about:blank"]
        if not command[0]:
            sys.exit("check_report.py: there is no `chromium`; install that package")
        shell = 'in=$1; out=$2; shift 2; eval "exec 3<&$in 4>&$out"; exec "$@"'
        self.process = subprocess.Popen(["bash", "-c", shell, "bash", str(to_read), str(to_write)] + command,
                                        pass_fds=(to_read, to_write), stderr=subprocess.DEVNULL)
        os.close(to_read)
        os.close(to_write)
        self.pending, self.number, self.events = b"", 0, []

    def receive(self):
        while b"\0" not in self.pending:
            piece = os.read(self.read_end, 1 << 20)
            if not piece:
                raise EOFError("Chromium has gone")
            self.pending += piece
        text, self.pending = self.pending.split(b"\0", 1)
        return json.loads(text)

    def send(self, method, session=None, **params):
        self.number += 1
        message = {"id": self.number, "method": method, "params": params}
        if session:
            message["sessionId"] = session
        data = json.dumps(message).encode() + b"\0"
        while data:
            data = data[os.write(self.write_end, data):]
        while True:
            answer = self.receive()
            if answer.get("id") == self.number:
                if "error" in answer:
                    raise RuntimeError(f"{method}: {answer['error']['message']}")
                return answer["result"]
            self.events.append(answer)


class Page:
    """One tab with the report, of one size."""

    def __init__(self, browser, path, name):
        self.browser, self.name, self.amiss = browser, name, []
        self.width, self.height = SIZES[name]
        target = browser.send("Target.createTarget", url="about:blank")["targetId"]
        self.session = browser.send("Target.attachToTarget", targetId=target, flatten=True)["sessionId"]
        self.is_phone = name == "phone"
        for domain in ("Page", "Runtime", "Log", "Network"):
            self.send(domain + ".enable")
        self.send("Emulation.setDeviceMetricsOverride", width=self.width, height=self.height,
                  deviceScaleFactor=2 if self.is_phone else 1, mobile=self.is_phone)
        self.send("Emulation.setTouchEmulationEnabled", enabled=self.is_phone, maxTouchPoints=5)
        self.url = path.resolve().as_uri()
        self.send("Page.navigate", url=self.url)
        self.wait("document.documentElement && document.documentElement.dataset.ready", 120)
        self.settle()
        self.load_s = self.js("performance.now() / 1000")

    def send(self, method, **params):
        return self.browser.send(method, self.session, **params)

    def js(self, expression):
        result = self.send("Runtime.evaluate", expression=expression, awaitPromise=True, returnByValue=True)
        if "exceptionDetails" in result:
            raise RuntimeError(f"{expression}: {result['exceptionDetails']}")
        return result["result"].get("value")

    def wait(self, expression, limit_s):
        end = time.monotonic() + limit_s
        while not self.js(expression):
            if time.monotonic() > end:
                raise TimeoutError(expression)
            time.sleep(0.05)

    def settle(self):
        self.js("new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => requestAnimationFrame(r))))")

    def check(self, is_right, what):
        if not is_right:
            self.amiss.append(f"{self.name}: {what}")

    def place(self, selector, index=0):
        """Middle of an element, scrolled into sight; None when it is hidden."""
        return self.js(f"""(() => {{
            const e = document.querySelectorAll({json.dumps(selector)})[{index}];
            if (!e || !e.getClientRects().length) return null;
            e.scrollIntoView({{ block: "center", behavior: "instant" }});
            const b = e.getBoundingClientRect();
            return [b.left + b.width / 2, b.top + b.height / 2, b.width, b.height];
        }})()""")

    def count(self, selector):
        return self.js(f"document.querySelectorAll({json.dumps(selector)}).length")

    def click_at(self, x, y):
        if self.is_phone:
            self.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
            self.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
        else:
            for kind in ("mousePressed", "mouseReleased"):
                self.send("Input.dispatchMouseEvent", type=kind, x=x, y=y, button="left", clickCount=1)
        self.settle()

    def click(self, selector, index=0):
        at = self.place(selector, index)
        if at:
            self.click_at(at[0], at[1])
        return at is not None

    def set_value(self, selector, value, index=0):
        self.js(f"""(() => {{
            const e = document.querySelectorAll({json.dumps(selector)})[{index}];
            e.value = {json.dumps(value)};
            for (const kind of ["input", "change"]) e.dispatchEvent(new Event(kind, {{ bubbles: true }}));
        }})()""")
        self.settle()

    def picture(self, selector="#viewer canvas", index=0):
        self.settle()
        return self.js(f"document.querySelectorAll({json.dumps(selector)})[{index}].toDataURL()")

    def screenshot(self, folder, name, whole=False):
        if folder:
            clip = {}
            if whole:  # a picture higher than a texture can be would show the page's top again
                height, ratio = self.js("[document.documentElement.scrollHeight, devicePixelRatio]")
                clip = {"captureBeyondViewport": True, "clip": {
                    "x": 0, "y": 0, "width": self.width, "height": height,
                    "scale": min(1, HIGHEST_PICTURE_PX / (height * ratio))}}
            data = self.send("Page.captureScreenshot", format="png", **clip)["data"]
            (folder / f"{self.name}-{name}.png").write_bytes(base64.b64decode(data))


def look_for_errors(page):
    for event in page.browser.events:
        if event.get("sessionId") != page.session:
            continue
        method, params = event.get("method"), event.get("params", {})
        if method == "Runtime.exceptionThrown":
            page.check(False, "exception: " + json.dumps(params["exceptionDetails"])[:400])
        elif method == "Runtime.consoleAPICalled" and params["type"] in ("error", "warning"):
            page.check(False, "console: " + json.dumps(params["args"])[:400])
        elif method == "Log.entryAdded" and params["entry"]["level"] == "error":
            page.check(False, "log: " + params["entry"]["text"][:400])
        elif method == "Network.requestWillBeSent":
            url = params["request"]["url"]
            page.check(url.startswith("data:") or url.split("#")[0] == page.url, "request to " + url[:100])


def check_first_sight(page, folder):
    page.check(page.js("document.documentElement.dataset.ready") == "true", "the page's script failed")
    page.check(page.js("document.documentElement.scrollWidth") <= page.width, "the page is wider than the screen")
    height = page.js("document.documentElement.scrollHeight")
    print(f"{page.name}: loaded in {page.load_s:.1f} s, {height} px high")
    if page.is_phone:
        page.check(height <= LONGEST_PHONE_PAGE_PX, f"the page is {height} px high, not at most {LONGEST_PHONE_PAGE_PX}")
    page.check(page.js("!!document.querySelector('.verdict strong').textContent"), "no verdict")
    page.screenshot(folder, "top")
    page.screenshot(folder, "page", whole=True)


def check_choices(page, folder):
    """Every option of every choice gives a picture of its own."""
    page.js("document.querySelectorAll('#viewer details').forEach(d => d.open = true)")
    for name in ("color", "fibers", "edges", "cut"):
        selector = f"#viewer select[name={name}]"
        if not page.count(selector):
            continue
        first = page.js(f"document.querySelector('{selector}').value")
        pictures = {}
        for option in page.js(f"[...document.querySelector('{selector}').options].map(o => o.value)"):
            page.set_value(selector, option)
            if option == "screen":
                page.click("#viewer [name=view-back]")
            picture = page.picture()
            same = [other for other, seen in pictures.items() if seen == picture]
            page.check(not same, f"{name} = {option} looks like {same}")
            pictures[option] = picture
            page.place("#viewer canvas")
            page.screenshot(folder, f"{name}-{option}")
            if name == "color" and option not in ("region", "surface"):
                page.check(page.js("document.querySelector('.legend3d').textContent.length > 4"), f"{option}: no legend")
        page.set_value(selector, first)


def check_cut(page, folder):
    page.set_value("#viewer select[name=cut]", "axial")
    before = page.picture()
    low, high = page.js("(e => [Number(e.min), Number(e.max)])(document.querySelector('[name=cutAt]'))")
    page.set_value("[name=cutAt]", str(low + 0.4 * (high - low)))
    page.check(page.picture() != before, "the cut's slider changes nothing")
    page.check(" mm" in page.js("document.querySelector('.cut output').textContent"), "the cut's place has no unit")
    for color in page.js("[...document.querySelector('[name=color]').options].map(o => o.value)"):
        page.set_value("#viewer select[name=color]", color)
        page.set_value("#viewer select[name=fibers]", "plain")
        page.place("#viewer canvas")
        page.screenshot(folder, f"cut-{color}")
    at = page.place("#viewer canvas")
    page.click_at(at[0], at[1])
    page.set_value("#viewer select[name=cut]", "none")
    page.set_value("#viewer select[name=fibers]", "off")
    page.set_value("#viewer select[name=color]", "region")


def check_parts(page, folder):
    page.js("document.querySelectorAll('#viewer details').forEach(d => d.open = true)")
    empty = None
    for name in ("none", "all", "blood", "walls"):
        index = page.js(f"[...document.querySelectorAll('#viewer button')].findIndex(b => b.textContent === '{name}')")
        page.check(page.click("#viewer button", index), f"no button {name}")
        picture = page.picture()
        if name == "none":
            empty = picture
        page.check(name == "none" or picture != empty, f"{name} shows nothing")
    for index in range(page.count("#viewer .only")):
        page.click("#viewer .only", index)
        page.click("#viewer [name=fit]")
        label = page.js(f"document.querySelectorAll('#viewer .only')[{index}].title")
        page.check(page.picture() != empty, f"{label}: nothing to see")
        page.check(page.js("document.querySelectorAll('#viewer .part input:checked').length") == 1, f"{label}: others show")
        page.place("#viewer canvas")
        page.screenshot(folder, "only-" + label.replace("show only ", "").replace(" ", "_"))
    index = page.js("[...document.querySelectorAll('#viewer button')].findIndex(b => b.textContent === 'walls')")
    page.click("#viewer button", index)
    page.click("#viewer [name=fit]")
    before = page.picture()
    box = page.js("[...document.querySelectorAll('#viewer .part input')].findIndex(b => b.checked)")
    page.click("#viewer .part input", box)
    page.check(page.picture() != before, "a part's box changes nothing")
    page.click("#viewer .part input", box)


def check_directions(page):
    seen = set()
    for index in range(page.count("#viewer .views button[name^=view-]")):
        page.click("#viewer .views button[name^=view-]", index)
        seen.add(page.picture())
    page.check(len(seen) == page.count("#viewer .views button[name^=view-]"), "two directions look the same")
    page.click("#viewer [name=view-front]")


def check_hands(page, folder):
    x, y, width, height = page.place("#viewer canvas")
    page.click_at(x - 0.1 * width, y)
    facts = page.js("document.querySelector('#viewer .facts').innerText")
    for word in ("region", "surface", "smallest dihedral", "L, P, S"):
        page.check(word in facts, f"a click on the heart does not tell: {word} (it tells: {facts!r})")
    page.check(page.js("!document.querySelector('#viewer .mark').hidden"), "no mark at the place clicked")
    page.place("#viewer canvas")
    page.screenshot(folder, "clicked")
    before = page.picture()
    if page.is_phone:
        page.js("document.querySelector('h1').dispatchEvent(new PointerEvent('pointerdown', { bubbles: true }))")
        check_fingers(page)
        return
    page.send("Input.dispatchMouseEvent", type="mousePressed", x=x, y=y, button="left", buttons=1, clickCount=1)
    page.send("Input.dispatchMouseEvent", type="mouseMoved", x=x + 60, y=y + 20, button="left", buttons=1)
    page.send("Input.dispatchMouseEvent", type="mouseReleased", x=x + 60, y=y + 20, button="left")
    page.check(page.picture() != before, "dragging does not turn the heart")
    before = page.picture()
    page.send("Input.dispatchMouseEvent", type="mouseWheel", x=x, y=y, deltaX=0, deltaY=-200)
    page.settle()
    time.sleep(0.2)
    page.check(page.picture() != before, "the wheel does not zoom")


def check_fingers(page):
    x, y, _, _ = page.place("#viewer canvas")
    before, scale = page.picture(), page.js("visualViewport.scale")
    page.send("Input.synthesizePinchGesture", x=x, y=y, scaleFactor=1.8, relativeSpeed=800)
    page.check(page.picture() != before, "pinching does not zoom the heart")
    page.check(page.js("visualViewport.scale") == scale, "pinching zooms the page")
    before = page.picture()
    fingers = lambda dx, dy: [{"x": x - 40 + dx, "y": y + dy, "id": 1}, {"x": x + 40 + dx, "y": y + dy, "id": 2}]
    page.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=fingers(0, 0))
    for step in range(1, 6):
        page.send("Input.dispatchTouchEvent", type="touchMove", touchPoints=fingers(8 * step, 4 * step))
    page.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    page.check(page.picture() != before, "two fingers do not move the heart")
    top = page.js("scrollY")
    swipe(page, x, y, 0, -25)
    page.check(page.js("scrollY") > top + 100, "a finger on the heart does not scroll the page")
    x, y, _, _ = page.place("#viewer canvas")
    before = page.picture()
    swipe(page, x, y, 10, 0)
    page.check(page.picture() != before, "a finger to the side does not turn the heart")
    page.click("#viewer [name=fit]")


def swipe(page, x, y, dx, dy):
    page.send("Input.dispatchTouchEvent", type="touchStart", touchPoints=[{"x": x, "y": y}])
    for step in range(1, 11):
        page.send("Input.dispatchTouchEvent", type="touchMove", touchPoints=[{"x": x + dx * step, "y": y + dy * step}])
    page.send("Input.dispatchTouchEvent", type="touchEnd", touchPoints=[])
    time.sleep(0.5)
    page.settle()


def check_slices(page, folder):
    if not page.count("#slices .pane"):
        return
    page.js("document.querySelectorAll('#slices details').forEach(d => d.open = true)")
    for index, name in enumerate(("axial", "coronal", "sagittal")):
        if page.is_phone:
            page.check(page.click(f"#slices [name=plane-{name}]"), f"no tab {name}")
        before = page.picture("#slices canvas", index)
        slider = f"#slices [name=slice-{name}]"
        page.set_value(slider, page.js(f"String(Math.round((e => e.value * 0.8 + 2)(document.querySelector('{slider}'))))"))
        page.check(page.picture("#slices canvas", index) != before, f"{name}: the slider changes nothing")
        before = page.picture("#slices canvas", index)
        for control in ("contours", "fill"):
            page.click(f"#slices [name={control}]")
            page.check(page.picture("#slices canvas", index) != before, f"{name}: {control} changes nothing")
            page.click(f"#slices [name={control}]")
        if page.count("#slices [name=level]"):
            for control, value in (("level", "400"), ("width", "300")):
                old = page.js(f"document.querySelector('#slices [name={control}]').value")
                page.set_value(f"#slices [name={control}]", value)
                page.check(page.picture("#slices canvas", index) != before, f"{name}: {control} changes nothing")
                page.set_value(f"#slices [name={control}]", old)
        page.click("#slices canvas", index)
        page.check("mm" in page.js("document.querySelector('#slices > .facts').innerText"), f"{name}: a click tells nothing")
        page.place("#slices")
        page.screenshot(folder, f"slices-{name}")


def check_rows(page, folder):
    page.js("document.querySelectorAll('details').forEach(d => d.open = true)")
    for index in range(page.count("[data-show]")):
        if not page.click("[data-show]", index):
            continue
        name = page.js(f"document.querySelectorAll('[data-show]')[{index}].dataset.show")
        page.check(page.js("document.querySelectorAll('#viewer .part input:checked').length") > 0, f"{name}: nothing is shown")
        if index < 3:
            page.js("document.getElementById('view').scrollIntoView({ behavior: 'instant' })")
            page.screenshot(folder, f"row-{index}")
    silent = page.js("""[...document.querySelectorAll(".term")].filter(e => {
        e.click();
        const box = document.getElementById("term");
        return box.hidden || box.textContent.length < e.textContent.length + 5;
    }).map(e => e.textContent)""")
    page.check(not silent, f"words that explain nothing: {silent}")
    if page.click(".term"):
        page.screenshot(folder, "term")
    page.js("document.body.click()")


def check_everything_else(page, folder):
    for index in range(page.count("button.copy")):
        page.click("button.copy", index)
        page.check("cop" in page.js(f"document.querySelectorAll('button.copy')[{index}].textContent"), "copy does nothing")
    for index in range(page.count("nav a")):
        page.click("nav a", index)
    page.check(page.js("document.documentElement.scrollWidth") <= page.width, "opened, the page is wider than the screen")
    page.screenshot(folder, "opened", whole=True)


def check(browser, path, name, folder):
    page = Page(browser, path, name)
    check_first_sight(page, folder)
    if page.count("#viewer .panel select"):
        for step in (check_hands, check_choices, check_cut, check_parts):
            step(page, folder)
        check_directions(page)
    for step in (check_slices, check_rows, check_everything_else):
        step(page, folder)
    look_for_errors(page)
    return page.amiss


def main():
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    path = pathlib.Path(sys.argv[1])
    folder = pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else None
    if folder:
        folder.mkdir(parents=True, exist_ok=True)
    amiss = []
    size = path.stat().st_size
    if size > LARGEST_PAGE_BYTES:
        amiss.append(f"the page has {size / 1e6:.1f} MB")
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile:
        browser = Browser(profile)
        try:
            for name in SIZES:
                amiss += check(browser, path, name, folder)
        finally:
            browser.process.terminate()
            browser.process.wait()
    print(f"{path.name}: {size / 1e6:.1f} MB; " + ("everything works" if not amiss else f"{len(amiss)} amiss"))
    for line in amiss:
        print("  " + line)
    sys.exit(1 if amiss else 0)


if __name__ == "__main__":
    main()
