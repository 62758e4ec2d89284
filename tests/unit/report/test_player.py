"""The player in a browser without a window: what a person would click, and what is then seen."""

import io
import re
import shutil

import numpy as np
import pytest
from numpy.testing import assert_allclose
from PIL import Image

import cayley as cy
from cayley import modes
from cayley.model import Box, Material, Model, Rod, Section, supports
from cayley.report import write_modes, write_report
from cayley.report.player import page as player_page
from cayley.report.scene import Block, Flat, Quantity, Scene, Skin, Strand
from cayley.report.swing import shown
from unit.report.growing import first_frames, serving

CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
if CHROMIUM is None:
    pytest.skip("the player is not clicked through: no chromium here (apt install chromium)", allow_module_level=True)
playwright = pytest.importorskip("playwright.sync_api", reason="the driver playwright is not installed")

SOFTWARE = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]  # WebGL without a graphics card

NO_WEBGL = """
const own = HTMLCanvasElement.prototype.getContext;
HTMLCanvasElement.prototype.getContext = function (kind, options) {
  return kind === "webgl2" ? null : own.call(this, kind, options);
};
"""


@pytest.fixture(scope="module")
def browser():
    with playwright.sync_playwright() as driver:
        own = driver.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE)
        yield own
        own.close()


@pytest.fixture
def show(browser):
    """Open an address; at the end nothing may have been said in the console, and nothing asked from elsewhere."""
    said, pages = [], []

    def open_page(address, script=""):
        page = browser.new_page(viewport={"width": 1200, "height": 900})
        page.add_init_script(script)
        page.on("console", lambda message: said.append(message.text))
        page.on("pageerror", lambda error: said.append(str(error)))
        page.on("request", lambda request: said.append(request.url) if foreign(request.url) else None)
        page.goto(address)
        page.wait_for_function("window.player && player.scene")
        pages.append(page)
        return page

    yield open_page
    for page in pages:
        page.close()
    assert said == []


def foreign(address):
    return not address.startswith(("file:", "data:", "blob:", "http://127.0.0.1:"))


@pytest.fixture(scope="module")
def report(crane_report):
    return crane_report.as_uri()


def clock(page):
    return float(re.search(r"t = (\S+) s", page.inner_text("#clock")).group(1))


def picture(page):
    """Colors of the canvas, of the last picture drawn."""
    page.evaluate("() => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    return np.asarray(Image.open(io.BytesIO(page.locator("#picture").screenshot())).convert("RGB")).astype(int)


def changed(before, after):
    """Number of pixels that are not the same."""
    return int(np.count_nonzero(np.abs(after - before).max(axis=-1) > 24))


def inside(page, selector, across, down=0.5):
    """A place in an element, by parts of its width and height."""
    found = page.locator(selector).first
    found.scroll_into_view_if_needed()
    box = found.bounding_box()
    return box["x"] + across * box["width"], box["y"] + down * box["height"]


def test_the_numbers_arrive(show, report, crane):
    page = show(report)
    assert page.title() == "A <crane> & more"
    position = page.evaluate("Array.from(player.scene.parts[1].position.row(40))")
    assert_allclose(np.reshape(position, (7, 3)), crane["boom"].position[40], atol=1e-6)
    moment = page.evaluate("Array.from(player.scene.parts[1].quantities[0].channel.row(40))")
    largest = float(np.abs(crane["boom"].moment).max())
    assert_allclose(np.reshape(moment, (7, 3)), crane["boom"].moment[40], atol=largest / 32767)
    energy = page.evaluate("Array.from(player.scene.graphs[0].channel.column(2))")
    assert energy == crane.energy.values.tolist()


def test_play_and_slide(show, report):
    page = show(report)
    start = picture(page)
    page.click("#play")
    page.wait_for_function("player.now > 0.05")
    page.click("#play")
    stopped = clock(page)
    assert changed(start, picture(page)) > 100
    page.wait_for_timeout(150)
    assert clock(page) == stopped
    page.mouse.click(*inside(page, "#slider", 0.75))
    assert clock(page) == pytest.approx(0.75, abs=0.03)
    page.locator("#picture").focus()
    page.keyboard.press("ArrowRight")
    assert clock(page) in (0.74, 0.76, 0.78)


def test_colors(show, report, crane):
    page = show(report)
    page.evaluate("player.go(0.8)")
    before = picture(page)
    page.select_option("#color", label="curvature e₂")
    assert page.inner_text("#colorname") == "curvature e₂ [1/m]"
    most = max(np.abs(_node_curvature(crane, name)[..., 1]).max() for name in ("mast", "boom"))
    assert float(page.inner_text("#high")) == pytest.approx(most, rel=0.01)
    assert changed(before, picture(page)) > 100
    page.select_option("#color", label="nothing")
    assert page.locator("#colorbar").is_hidden()


def _node_curvature(run, name):
    values = run[name].curvature.values
    return np.concatenate([values[:, :1], 0.5 * (values[:, 1:] + values[:, :-1]), values[:, -1:]], axis=1)


def test_what_can_be_added_to_the_picture(show, report):
    page = show(report)
    for box in ("#frames", "#ports"):
        before = picture(page)
        page.check(box)
        assert changed(before, picture(page)) > 30
    before = picture(page)
    page.select_option("#thickness", "5")
    assert changed(before, picture(page)) > 300


def test_camera(show, report):
    """Drag, wheel and buttons: each gives another picture, and a button brings the first one back."""
    page = show(report)
    first = before = picture(page)
    x, y = inside(page, "#picture", 0.5)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 120, y + 30, steps=3)
    page.mouse.up()
    for act in (
        lambda: None,
        lambda: page.mouse.wheel(0, -400),
        lambda: page.click("text=top"),
    ):
        act()
        after = picture(page)
        assert changed(before, after) > 300
        before = after
    page.click("text=oblique")
    assert changed(first, picture(page)) < 20


def test_plots_are_linked(show, report):
    """Pointing at one plot reads all at that time; a click brings the animation there."""
    page = show(report)
    assert page.locator("#graphs .plot").count() == 4
    page.mouse.move(*inside(page, "#graphs .plot:nth-child(1) .u-over", 0.5))
    readings = page.locator("#graphs .plot .u-legend tr:first-child .u-value, #over .u-legend tr:first-child .u-value")
    assert readings.all_inner_texts() == ["0.5"] * 5
    page.mouse.click(*inside(page, "#graphs .plot:nth-child(3) .u-over", 0.25))
    assert clock(page) == pytest.approx(0.25, abs=0.01)
    page.mouse.click(*inside(page, "#over .u-over", 0.6))
    assert clock(page) == pytest.approx(0.6, abs=0.01)


def test_choosing_a_node(show, report, crane):
    """By the list and the plot along the rod, by the slider, and by a click on the rod."""
    page = show(report)
    page.select_option("#part", label="boom")
    page.select_option("#quantity", label="force")
    page.mouse.click(*inside(page, "#along .u-over", 0.34))
    assert page.inner_text("#nodename").startswith("2 (s = 0.2667 m)")
    assert page.inner_text("#over .u-title") == "force at node 2 over the time"
    shown = page.evaluate("Array.from(player.over.data[3])")
    largest = float(np.abs(crane["boom"].force).max())
    assert_allclose(shown, crane["boom"].force[:, 2, 2], atol=largest / 32767)
    along = page.evaluate("player.go(0.5), player.along.data[2]")
    assert_allclose(along, crane["boom"].force[25, :, 1], atol=largest / 32767)
    box = page.locator("#picture").bounding_box()
    x, y = page.evaluate("player.picture.onScreen(player.picture.poses[0].place(4))")
    page.mouse.click(box["x"] + x, box["y"] + y)
    assert page.evaluate("player.selected") == {"part": 0, "node": 4}
    assert page.input_value("#part") == "0"


def test_without_webgl_there_are_the_plots(show, report):
    """The page says what is missing, and goes on."""
    page = show(report, NO_WEBGL)
    assert page.inner_text("#trouble") == "this browser has no WebGL 2, so the animation can't be shown."
    page.mouse.click(*inside(page, "#over .u-over", 0.5))
    assert clock(page) == pytest.approx(0.5, abs=0.01)


@pytest.mark.parametrize(("size", "seen"), [(2, False), (3, True)])
def test_a_lagrangian_of_ones_own(show, tmp_path, size, seen):
    """Vectors of three have a picture; others are plotted beside energy and momenta."""

    @cy.lagrangian(u=cy.Vector(size))
    def swing(q, c):
        return 0.5 * cy.dot(q.u_t, q.u_t) - 0.5 * cy.dot(q.u, q.u)

    run = cy.integrate(cy.compile(swing, rule=cy.rules.verlet), {"u": np.eye(size)[0]}, t_end=1.0, dt=0.1)
    page = show(write_report(run, tmp_path / "own.html").as_uri())
    assert page.locator("#picture").is_visible() == seen
    assert page.locator("#graphs .plot").count() == (3 if seen else 4)


def test_scenes(show, tmp_path):
    """Several scenes are chosen from a list; so mode shapes are shown."""
    time = np.linspace(0.0, 1.0, 11)
    circle = 0.05 * np.stack([np.cos(np.arange(12) * np.pi / 6), np.sin(np.arange(12) * np.pi / 6)], axis=-1)
    scenes = []
    for k in (1, 2):
        s = np.linspace(0.0, 1.0, 9)
        shape = np.outer(np.sin(2 * np.pi * time), 0.1 * np.sin(k * np.pi * s))
        position = np.stack([shape, 0.0 * shape, np.broadcast_to(s, shape.shape)], axis=-1)
        rotation = np.broadcast_to([1.0, 0.0, 0.0, 0.0], (11, 9, 4))
        size = {"size": Quantity(label="displacement", unit="m", values=np.abs(shape))}
        rod = Strand(name="rod", position=position, rotation=rotation, outlines=circle[None], s=s, quantities=size)
        scenes.append(Scene(name=f"mode {k}", time=time, parts=(rod,), note=f"{k}.5 Hz"))
    path = tmp_path / "modes.html"
    path.write_text(player_page(scenes, title="Modes"), encoding="utf-8")
    page = show(path.as_uri())
    page.evaluate("player.go(0.25)")
    before = picture(page)
    page.select_option("#scene", label="mode 2")
    page.wait_for_function("player.number === 1")
    assert "2.5 Hz" in page.inner_text("#note")
    page.evaluate("player.go(0.25)")
    assert changed(before, picture(page)) > 100


def test_obstacles(show, tmp_path):
    """A body is drawn by what it carries and moves with it; the room stands on the floor, which one sees through."""
    time, body = np.array([0.0, 1.0]), np.zeros((2, 1, 3))
    body[:, 0, 2] = 1.0, 0.5
    block = Block(name="dice", position=body, rotation=np.tile([1.0, 0, 0, 0], (2, 1, 1)), shaped=True)
    dice, step = Box((0.4, 0.4, 0.4)).mesh, Box((0.2, 0.2, 0.1), center=(0.8, 0, 0.05)).mesh
    solids = (
        Skin(name="dice", part=0, vertices=dice.vertices, triangles=dice.triangles),
        Skin(name="step", part=None, vertices=step.vertices, triangles=step.triangles),
        Flat(name="floor", part=None, point=(0.0, 0.0, 0.0), normal=(0.0, 0.0, 1.0)),
    )
    path = tmp_path / "obstacles.html"
    scene = Scene(name="all", time=time, parts=(block,), solids=solids)
    path.write_text(player_page([scene], title="Obstacles"), encoding="utf-8")
    page = show(path.as_uri())
    assert page.evaluate("[player.picture.low[2], player.picture.floor()]") == [0.0, 0.0]
    assert page.evaluate("player.scene.parts[0].reach") == pytest.approx(0.2 * 3**0.5)
    assert 0.9 < page.evaluate("player.picture.high[0]") < 1.2
    before = picture(page)
    page.evaluate("player.go(1)")
    assert changed(before, picture(page)) > 1000
    before = picture(page)
    page.evaluate("player.picture.obstacles.drawSheer = () => {}; player.draw()")
    pale = np.abs(picture(page) - before).max(axis=-1)
    assert np.count_nonzero(pale > 6) > 5000  # the floor is gone
    assert pale.max() < 100


def test_modes(show, tmp_path):
    """A click on a row of the table shows that mode, which plays until it is stopped, over and over; the view stays."""
    rubber = Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.4)
    rod = Rod(Section.rectangle(0.02, 0.04, rubber), length=1.0, elements=6)
    found = modes(Model(rod, supports=[supports.clamp(rod.start)]), count=3)
    page = show(write_modes(found, tmp_path / "modes.html", title="Modes").as_uri())
    assert page.evaluate("player.playing")
    page.click("text=side")
    page.click("[data-scene='2']")
    page.wait_for_function("player.number === 2 && player.playing")
    assert page.locator("[aria-selected=true]").get_attribute("data-scene") == "2"
    assert page.evaluate("player.picture.camera.azimuth") == 0.0
    page.wait_for_function("player.now > 0.5 * player.last")
    page.wait_for_function("player.now < 0.5 * player.last")  # it has begun again
    page.click("#play")
    page.evaluate("player.go(player.first)")
    one = picture(page)
    page.evaluate("player.go(player.last / 2)")
    assert changed(one, picture(page)) > 300
    shift = page.evaluate("Array.from(player.scene.parts[0].quantities[0].channel.row(0)).slice(-3)")
    assert_allclose(np.abs(shift), [shown(found, 2), 0.0, 0.0], atol=1e-4)
    page.focus("[data-scene='0']")
    page.keyboard.press("Enter")
    page.wait_for_function("player.number === 0 && player.playing")


def test_follows_a_run(show, crane, tmp_path):
    """The page of `cayley view` takes new frames by itself, and stays at the end if it was there."""
    store = tmp_path / "run.zarr"
    first_frames(crane, 20).save(store)
    with serving(store) as address:
        page = show(address)
        assert page.evaluate("player.scene.frames") == 20
        page.evaluate("player.go(player.last)")
        first_frames(crane, 45).save(store, overwrite=True)
        page.wait_for_function("player.scene.frames === 45", timeout=15_000)
        page.wait_for_function("player.now === player.last")
        assert clock(page) == pytest.approx(0.88)
        assert "45 frames" in page.inner_text("#live")
        page.close()
