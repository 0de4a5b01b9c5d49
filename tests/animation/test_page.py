"""Pages: numbers against closed forms, texts that are markup, the policy, and all models of the library."""

import base64
import hashlib
import html
import json
import math
import re
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.special import ellipj, ellipk

import lagc
from lagc.api.run import Run
from lagc.host.model_library import library_models
from lagc.reports.animation.page import Animation, Channels
from tests.animation.pages import Page

G, L, M = 9.81, 0.7, 1.3
PENDULUM = f"""
model P
  parameter Length l = {L} [m];
  parameter Mass m = {M} [kg];
  coordinate Angle theta(start = 2.5 [rad]);
  body bob = Particle(mass = m, at = {{l*sin(theta), 0, -l*cos(theta)}});
  Gravity field;
end P;
"""
EVIL = r"""
model Evil "</script><script>window.hacked=1</script><img src=x onerror='window.hacked=2'>"
  parameter Mass m = 1 [kg] "</style><script>window.hacked=3</script>";
  coordinate Length x(rate = 1 [m/s]) "<b onmouseover=window.hacked=4>x</b>";
  coordinate Length z(start = 1 [m]) "<!-- <script> \" ' ` & SEP";
  body ball = Particle(mass = m, at = {x, 0, z});
  Gravity field;
  constraint floor: ball.z >= 0 (restitution = 0.8);
  scene drop simulate(stop = 3 [s]); end drop;
  output Energy E = energy() "</script>&amp;<svg onload=window.hacked=5>";
end Evil;
""".replace("SEP", "\u2028\u2029")


def page_of(run: Run, **options: Any) -> Page:
    made = run.animate(**options)
    assert isinstance(made, Animation)
    return Page(made.html)


def amplitude(t: Any) -> Any:
    """The angle of a pendulum that starts at rest at 2.5 rad (Jacobi, 1829)."""
    k, w = math.sin(1.25), math.sqrt(G / L)
    return 2.0 * np.arcsin(k * ellipj(ellipk(k * k) - w * t, k * k)[0])


@pytest.fixture(scope="module")
def pendulum() -> Run:
    return lagc.loads(PENDULUM).compile(backend="numpy").simulate(10.0)


@pytest.mark.parametrize("points", [101, 501])
def test_positions_are_those_of_the_closed_form_within_what_the_page_states(points: int) -> None:
    run = lagc.loads(PENDULUM).compile(backend="numpy").simulate(10.0, points=points)
    page = page_of(run)
    t = np.random.default_rng(3).uniform(0.0, 10.0, 5000)
    theta = amplitude(t)
    exact = np.stack([L * np.sin(theta), 0.0 * t, -L * np.cos(theta)], 1)
    error = np.linalg.norm(page.path("bob", t) - exact, axis=1).max()
    stated = page.data["error"]
    assert error <= stated + L * run.errors["theta"]
    assert 0.02 * stated < error and stated < 5e-3 * L  # neither a false alarm nor useless


def test_the_tension_is_that_of_the_closed_form(pendulum: Run) -> None:
    """m (g cos theta + l w^2) towards the pivot."""
    page = page_of(pendulum)
    p, v = page.force("bob")
    theta, speed = (
        np.arctan2(p[:, 0], -p[:, 2]),
        np.sqrt(2.0 * G * L * (np.cos(amplitude(page.t)) - np.cos(2.5))),
    )
    size = M * (G * np.cos(theta) + speed**2 / L)
    pull = np.einsum("ni,ni->n", v, -p / L)
    assert np.abs(pull - size).max() < 1e-3 * np.abs(size).max()  # of 16 bits and of the places
    assert np.abs(np.linalg.norm(v, axis=1) - np.abs(pull)).max() < 1e-4 * size.max()
    weight = page.force("weight of bob", "weight")[1]
    assert weight[0] == pytest.approx([0.0, 0.0, -M * G], abs=1e-9)


def test_the_force_of_a_potential_is_a_load_and_the_tension_beside_it_a_reaction() -> None:
    """A torsion spring pushes the bob with k theta/l along its path; the rod pulls across it."""
    text = PENDULUM.replace("  Gravity field;\n", "  potential twist = 1/2*3 [N.m/rad2]*theta^2;\n")
    page = page_of(lagc.loads(text).compile(backend="numpy").simulate(2.0))
    p, load = page.force("bob", "load")
    theta = np.arctan2(p[:, 0], -p[:, 2])
    exact = (-3.0 * theta / L * np.stack([np.cos(theta), 0.0 * theta, np.sin(theta)])).T
    assert np.abs(load - exact).max() < 1e-3 * np.abs(exact).max()  # of 16 bits and of the places
    across = np.abs(np.cross(p, page.force("bob")[1])).max()
    assert across < 1e-3 * L * np.abs(exact).max()
    assert {f["kind"] for f in page.data["forces"]} == {"load", "reaction"}


def test_a_page_holds_both_sides_of_an_impact() -> None:
    """A ball that falls from h hits the floor at sqrt(2 h/g): there is the corner of its path."""
    text = EVIL.replace("z(start = 1 [m])", "z(start = 2 [m])")
    page = page_of(lagc.loads(text).compile(backend="numpy").simulate(1.0))
    hit = math.sqrt(4.0 / G)
    (event,) = page.data["events"]
    assert event["kind"] == "impact" and event["t"] == pytest.approx(hit, rel=1e-9)
    assert page.path("ball", [hit])[0, 2] == pytest.approx(0.0, abs=1e-4)
    assert np.sum(np.abs(page.t - hit) < 1e-8) == 2
    assert [page.data["places"][i]["name"] for i in event["at"]] == ["ball"]
    speed = math.sqrt(4.0 * G)
    assert event["impulse"] == pytest.approx(1.8 * speed, rel=1e-6)
    assert event["loss"] == pytest.approx((1.0 - 0.64) * 2.0 * G, rel=1e-6)


def test_frames_between_recorded_points_follow_the_motion() -> None:
    """A page of a run with 41 points, of which straight lines would cut the corners of the arc."""
    run = lagc.loads(PENDULUM).compile(backend="numpy").simulate(3.0, points=41)
    page = page_of(run)
    assert page.n > 100
    theta = amplitude(page.t)
    exact = np.stack([L * np.sin(theta), -L * np.cos(theta)], 1)
    assert np.abs(page.path("bob", page.t)[:, [0, 2]] - exact).max() <= page.data["error"]


def test_other_runs_are_ghosts_with_their_labels(pendulum: Run) -> None:
    system = lagc.loads(PENDULUM).compile(backend="numpy")
    others = [system.simulate(10.0, parameters={"l": 0.5}), system.simulate(4.0, starts={"theta": 1.0})]
    page = page_of(pendulum, overlay=others)
    assert [run["label"] for run in page.data["runs"]] == ["", "l = 0.5", "theta = 1"]
    assert [run["end"] for run in page.data["runs"]] == [10.0, 10.0, 4.0]
    assert np.linalg.norm(page.path("bob", [0.0, 1.0, 2.0], run=1), axis=1) == pytest.approx(0.5, abs=1e-3)
    assert len(page.data["panels"][0]["columns"][0]["y"]) == 3
    named = page_of(pendulum, overlay={"short": others[0]})
    assert named.data["runs"][1]["label"] == "short"


def test_a_ghost_of_another_scene_may_lack_places() -> None:
    text = PENDULUM.replace("end P;", "  effect more\n    point Q = {l, 0, 0};\n  end more;\n"
                            "  scene a uses more end a;\n  scene b end b;\nend P;")  # fmt: skip
    model = lagc.loads(text)
    runs = [model.compile(scene=scene, backend="numpy").simulate(1.0, points=51) for scene in "ab"]
    page = page_of(runs[0], overlay=[runs[1]])
    place = str(page.place("Q", "point"))
    assert page.data["runs"][1]["label"] == "b"
    assert place in page.data["runs"][0]["P"] and place not in page.data["runs"][1]["P"]


def test_texts_of_a_model_are_no_markup() -> None:
    page = page_of(lagc.loads(EVIL).compile(backend="numpy").simulate(0.2, points=11))
    assert page.data["about"].startswith("</script><script>")
    assert page.data["panels"][0]["columns"][1]["about"].endswith("\u2028\u2029")
    bare = re.sub(r"<script>.*?</script>|<style>.*?</style>", "", page.text, flags=re.DOTALL)
    (block,) = re.findall(r'<script type="application/json" id="data">(.*?)</script>', bare, flags=re.DOTALL)
    assert "<" not in block and block.isascii()
    assert "hacked" not in bare.replace(block, "")
    assert page.text.count("<script") == 2 and page.text.count("</script") == 2


def test_the_policy_allows_the_two_blocks_of_the_page_and_nothing_else(pendulum: Run) -> None:
    text = page_of(pendulum).text
    (policy,) = re.findall(r'http-equiv="Content-Security-Policy" content="(.*?)"', text)
    rules = dict(rule.split(" ", 1) for rule in html.unescape(policy).split("; "))
    for kind, tag in (("script-src", "script"), ("style-src", "style")):
        (block,) = re.findall(f"<{tag}>(.*?)</{tag}>", text, flags=re.DOTALL)
        digest = base64.b64encode(hashlib.sha256(block.encode()).digest()).decode()
        assert rules[kind] == f"'sha256-{digest}'"
        assert "Permission is hereby granted" in block and "uplot 1." in block
    assert rules["default-src"] == rules["base-uri"] == rules["form-action"] == "'none'"
    assert "three.js" in text and not re.findall(r"(?:src|href)=[\"']?https?:", text)


def test_the_same_run_gives_the_same_bytes(pendulum: Run) -> None:
    again = lagc.loads(PENDULUM).compile(backend="numpy").simulate(10.0)
    one, other = pendulum.animate(), again.animate()
    assert isinstance(one, Animation) and isinstance(other, Animation) and one.html == other.html


def test_a_notebook_shows_a_page_in_a_frame_without_rights(pendulum: Run) -> None:
    made = pendulum.animate()
    assert isinstance(made, Animation)
    frame = made._repr_html_()
    assert frame.startswith('<iframe sandbox="allow-scripts allow-downloads"')
    (inside,) = re.findall(r'srcdoc="(.*)"></iframe>', frame, flags=re.DOTALL)
    assert html.unescape(inside) == made.html and '"' not in inside


def test_a_run_that_failed_is_shown_until_then() -> None:
    text = PENDULUM.replace("end P;", '  when theta < 0 then terminate("low"); end when;\nend P;')
    page = page_of(lagc.loads(text).compile(backend="numpy").simulate(10.0))
    assert page.data["status"] == "terminated" and page.data["runs"][0]["end"] < 1.5
    assert page.decode_all() > 0


def test_channels_are_exact_to_their_range() -> None:
    chance = np.random.default_rng(1)
    for n in (1, 2, 7, 1000):
        x = chance.normal(size=n) * 10.0 ** chance.uniform(-8, 8)
        channels = Channels()
        channel = channels.add(x)
        page = Page('<script type="application/json" id="data">' + json.dumps(
            {"blob": channels.text(), "counts": [n], "runs": [{"t": [channel]}]}) + "</script>")  # fmt: skip
        assert np.abs(page.t - x).max() <= (x.max() - x.min()) / 131_068.0 + 1e-15 * np.abs(x).max()
        assert channels.add(x) == channel and channels.size in (0, n)  # stored once
    times = np.sort(chance.uniform(0.0, 100.0, 999))
    channels = Channels()
    sums = [np.array(c) for c in channels.add_times(times)]
    assert len(sums) == 2
    gap = Channels().add([1.0, math.nan, 3.0])
    assert gap[:2] == [1.0, 3.0]


@pytest.mark.sample(2)
@pytest.mark.parametrize(
    "name", sorted(library_models(), key=lambda name: hashlib.sha256(name.encode()).digest())
)
def test_every_library_model_gives_a_page_that_decodes(name: str) -> None:
    system = lagc.load(name).compile(backend="numpy")
    stop = system.interface.simulate.get("stop", 10.0)
    run = system.simulate(min(stop, 1.0) if stop < 1e3 else stop, points=51, method="dop853", rtol=1e-6)
    page = page_of(run)
    assert page.decode_all() > len(run.t)
    assert [body["name"] for body in page.data["bodies"]] == [body.name for body in system.model.bodies]
    for place in page.data["runs"][0]["P"]:
        assert page.data["places"][int(place)] is not None
    assert 0.0 <= page.data["error"] < 0.05 * page.data["scale"]


@pytest.mark.skipif(find_spec("PIL") is None, reason="films need matplotlib with Pillow")
def test_a_film_has_moving_pictures(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from PIL import Image

    from lagc.reports.animation import film

    monkeypatch.setattr(film, "FEW_PICTURES", 3)
    monkeypatch.setattr(film, "MOST_PICTURES", 3)
    path = tmp_path / "p.gif"
    run = lagc.loads(PENDULUM).compile(backend="numpy").simulate(1.0, points=51)
    assert run.animate(str(path)) == str(path)
    with Image.open(path) as image:
        assert image.n_frames == 3
        frames = []
        for k in range(3):
            image.seek(k)
            frames.append(np.asarray(image.convert("L")).copy())
    assert all((a != b).mean() > 1e-3 for a, b in pairwise(frames))


def test_a_wrong_ending_and_an_empty_run_are_refused(pendulum: Run) -> None:
    with pytest.raises(ValueError, match=r"\.html \.gif \.mp4"):
        pendulum.animate("x.pdf")
    bare = Run(**{name: getattr(pendulum, name) for name in type(pendulum).__match_args__})
    with pytest.raises(ValueError, match="no model"):
        bare.animate()


def test_friction_is_along_the_plane(tmp_path: Path) -> None:
    """mu N against the slip while a block slides up; what holds it against its weight when it sticks."""
    run = lagc.load("incline").compile(backend="numpy").simulate(method="dop853", rtol=1e-9)
    run.animate(str(tmp_path / "page.html"))
    shown = Page((tmp_path / "page.html").read_text())
    _, v = shown.force("friction of slope")
    stop = next(event.t for event in run.events if event.name.endswith("sticks"))
    slides, sticks = -0.7 * 9.81 * math.cos(math.radians(30)), 9.81 * math.sin(math.radians(30))
    assert np.abs(v[shown.t < stop - 1e-6, 0] - slides).max() < 1e-3
    assert np.abs(v[shown.t > stop + 1e-6, 0] - sticks).max() < 1e-3
    assert np.abs(v[:, 1:]).max() < 1e-3


def test_friction_of_one_of_two_contacts_is_not_told() -> None:
    """The force of both on a ladder, along the floor, is mostly the push of the wall."""
    text = """model L
      coordinate Length x(start = 1 [m]*cos(1.1)), y(start = 1 [m]*sin(1.1));
      coordinate Angle phi(start = 1.1);
      frame F = rotate_z(world, -phi);
      body ladder = Solid(mass = 8 [kg], inertia = {0, 1, 1}, frame = F, com = {x, y, 0});
      point A = {x, y, 0} - 1 [m]*F.x;
      point B = {x, y, 0} + 1 [m]*F.x;
      constraint wall: A.x >= 0 (friction = 0.1, at = A);
      constraint floor: B.y >= 0 (friction = 0.1, at = B);
      Gravity field(direction = {0, -1, 0});
    end L;
    """
    page = page_of(lagc.loads(text).compile(backend="numpy").simulate(0.5))
    assert {f["name"] for f in page.data["forces"]} == {"weight of ladder", "wall", "floor"}
