"""Screenshots of a report: python docs/make_screenshots.py (a minute; needs chromium and playwright)."""

import shutil
import tempfile
from pathlib import Path

from PIL import Image
from playwright.sync_api import Page, sync_playwright

import cayley as cy
from cayley import joints, loads, springs, supports
from cayley.report import write_report

IMAGES = Path(__file__).resolve().parent / "images"
SOFTWARE = ["--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]  # WebGL without a graphics card


def crane() -> cy.Trajectory:
    """A soft mast that tapers, a boom on a hinge, and a weight on a ball joint, let go."""
    rubber = cy.Material(density=1100.0, youngs_modulus=2e6, poisson_ratio=0.4)
    mast = cy.Rod(lambda s: cy.Section.circle(0.05 - 0.03 * s, rubber), length=1.0, elements=16, name="mast")
    beam = cy.Section.i_beam(width=0.06, height=0.08, flange=0.012, web=0.01, material=rubber)
    boom = cy.Rod(beam, length=0.8, elements=16, origin=(0, 0, 1.0), direction=(1, 0, 0), normal=(0, 1, 0), name="boom")
    ports = {"eye": (0, 0, 0.2), "hook": (0.05, 0, -0.05)}
    weight = cy.Body(mass=0.4, inertia=[1e-3, 2e-3, 1.5e-3], position=(0.8, 0, 0.8), ports=ports, name="weight")
    model = cy.Model(
        mast,
        boom,
        weight,
        supports=[supports.clamp(mast.start)],
        joints=[joints.hinge(mast.end, boom.start, axis=(0, 1, 0)), joints.ball(boom.end, weight.port("eye"))],
        springs=[springs.linear(boom.node(8), mast.node(8), stiffness=60.0, length=0.5, damping=0.5)],
        loads=[loads.gravity((0, 0, -9.81)), loads.force(weight.centre, (0, 1.0, 0), until=0.5)],
    )
    return cy.simulate(model, t_end=2.0, save_every=0.01, balance=True)


def save(page: Page, name: str) -> None:
    """A screenshot of the player, with few colors so that the file is small."""
    page.wait_for_timeout(300)
    path = IMAGES / name
    page.locator("#player").screenshot(path=path)
    with Image.open(path) as picture:
        picture.convert("RGB").quantize(256, dither=Image.Dither.NONE).save(path, optimize=True)
    print(f"{path}: {path.stat().st_size / 1000:.0f} kB")


def main() -> None:
    """Write the report of the crane and take pictures of it."""
    program = shutil.which("chromium") or shutil.which("google-chrome")
    with tempfile.TemporaryDirectory() as folder, sync_playwright() as driver:
        report = write_report(crane(), Path(folder) / "report.html", title="A crane of rubber")
        browser = driver.chromium.launch(executable_path=program, args=SOFTWARE)
        page = browser.new_page(viewport={"width": 1280, "height": 1000})
        page.goto(report.as_uri())
        page.wait_for_function("window.player && player.scene")
        page.evaluate("player.go(0.66)")
        page.mouse.move(640, 900)
        save(page, "report.png")
        page.select_option("#color", label="curvature e₁")
        page.check("#frames")
        page.check("#ports")
        page.select_option("#part", label="boom")
        page.select_option("#quantity", label="force")
        page.evaluate("player.go(1.2)")
        over = page.locator("#over .u-over").bounding_box()
        assert over is not None
        page.mouse.move(over["x"] + 0.7 * over["width"], over["y"] + 50)
        save(page, "report_frames.png")
        browser.close()


if __name__ == "__main__":
    main()
