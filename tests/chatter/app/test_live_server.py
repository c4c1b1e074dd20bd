"""The page of live lobes over HTTP: answers, and what is refused."""

from __future__ import annotations

import http.client
import json
import threading

import numpy as np
import pytest
import tomlkit

import chatter
from chatter.app.live_case import LiveCase
from chatter.app.newest_request import NewestRequest, SupersededError
from chatter.app.server import LARGEST_REQUEST, LiveServer
from chatter.app.sliders import case_sliders
from chatter.description.errors import InputError, RunError
from tests.places import EXAMPLES

CASE = EXAMPLES / "two-degrees-of-freedom" / "case.toml"


@pytest.fixture(scope="module")
def server():
    serving = LiveServer(LiveCase(chatter.load(CASE), "zero-order"))
    thread = threading.Thread(target=serving.serve_forever, kwargs={"poll_interval": 0.02})
    thread.start()
    yield serving
    serving.shutdown()
    thread.join()
    serving.end()


def call(server, method, path, body=None, headers=None, token=None):
    """Status, headers and content of an answer."""
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=30)
    sent = {"Content-Type": "application/json"} if body is not None else {}
    text = body if isinstance(body, (bytes, type(None))) else json.dumps(body).encode()
    try:
        connection.request(
            method, f"/{token or server.token}/{path}", text, {**sent, **(headers or {})}
        )
        answer = connection.getresponse()
        return answer.status, answer.headers, answer.read()
    finally:
        connection.close()


def post(server, path, **given):
    status, _, content = call(server, "POST", path, {"page": "test", "values": {}, **given})
    return status, json.loads(content)


def test_page_refers_to_nothing_elsewhere(server):
    status, headers, content = call(server, "GET", "")
    assert status == 200
    assert headers["Content-Type"].startswith("text/html")
    assert "default-src 'none'" in headers["Content-Security-Policy"]
    for name in ("live.css", "live.js", "draw.js"):
        status, _, part = call(server, "GET", name)
        assert status == 200
        content += part
    assert b"http://" not in content
    assert b"https://" not in content


def test_sliders_hold_the_values_of_the_case(server):
    _, _, content = call(server, "GET", "setup")
    told = {one["path"]: one for one in json.loads(content)["sliders"]}
    assert told["material.Ktc"]["value"] == pytest.approx(600.0)
    assert told["structure.mode[1].damping"]["value"] == pytest.approx(0.011)
    assert told["tool.teeth"]["whole"]
    assert told["lobes.depths.to"]["value"] == pytest.approx(10.0)
    assert all(one["low"] <= one["value"] <= one["high"] for one in told.values())
    # the limits of the linear law do not depend on the feed
    assert "cut.feed_per_tooth" not in told


def test_diagram_is_that_of_the_command(server):
    status, told = post(server, "diagram", stage="fine")
    assert status == 200
    case = chatter.load(CASE)
    wanted = chatter.lobes(case, "zero-order").limits
    rpm = wanted.spindle_speed * 30.0 / np.pi
    shown = [depths[0] if depths else 10.0 for depths in told["crossings_mm"]]
    expected = np.interp(told["spindle_speed_rpm"], rpm, np.minimum(wanted.critical_depth, 0.01))
    # the two grids of speeds are not the same, and the lobes have corners
    assert np.median(np.abs(np.array(shown) / (1e3 * expected) - 1.0)) < 0.01


def test_limit_is_inverse_to_the_coefficients(server):
    _, told = post(server, "diagram", stage="coarse")
    values = {"material.Ktc": 1200.0, "material.Krc": 400.0, "lobes.depths.to": 5.0}
    _, doubled = post(server, "diagram", stage="coarse", values=values)
    assert doubled["lowest"]["depth_mm"] == pytest.approx(0.5 * told["lowest"]["depth_mm"])


def test_click_simulates_the_point(server):
    # well above and well below the lowest limit of about 1.3 mm
    point = {"spindle_speed_rpm": 15500.0, "axial_depth_mm": 0.3}
    status, told = post(server, "simulation", **point)
    assert status == 200
    assert told["verdict"] == "stable"
    assert len(told["revolutions"]) == len(told["lowest_um"]) == len(told["highest_um"])
    assert all(low <= high for low, high in zip(told["lowest_um"], told["highest_um"], strict=True))


def test_saved_case_holds_what_was_moved(server):
    values = {"material.Ktc": 700.0, "tool.teeth": 3, "lobes.speeds.to": 20000.0}
    status, headers, content = call(server, "POST", "case", {"values": values})
    assert status == 200
    assert headers["Content-Type"].startswith("application/toml")
    saved = tomlkit.parse(content.decode())
    assert saved["material"]["Ktc"] == "700 MPa"
    assert saved["tool"]["teeth"] == 3
    assert saved["lobes"]["speeds"]["to"] == "20000 rpm"
    assert "the benchmark of insperger" in content.decode().lower()


@pytest.mark.parametrize(
    ("headers", "token", "status"),
    [
        ({"Host": "attacker.example"}, None, 403),
        ({"Host": "127.0.0.1"}, None, 403),
        ({"Origin": "http://attacker.example"}, None, 403),
        ({}, "guess", 403),
    ],
)
def test_foreign_callers_are_refused(server, headers, token, status):
    for method, path, body in (("GET", "", None), ("POST", "case", {"values": {}})):
        found, _, content = call(server, method, path, body, headers, token)
        assert found == status
        assert server.token.encode() not in content


@pytest.mark.parametrize("path", ["../server.py", "page/live.js", "%2e%2e/server.py", "diagram"])
def test_unknown_pages_are_refused(server, path):
    assert call(server, "GET", path)[0] == 404


@pytest.mark.parametrize(
    ("body", "headers", "status"),
    [
        (b"{" + b" " * LARGEST_REQUEST + b"}", {}, 413),
        (b"{}", {"Content-Length": "-1"}, 411),
        (b"{", {}, 400),
        (b"[" * 20000, {}, 400),
        (b"[]", {}, 400),
        (b"{}", {"Content-Type": "text/plain"}, 415),
    ],
)
def test_requests_out_of_form_are_refused(server, body, headers, status):
    found, _, content = call(server, "POST", "case", body, headers)
    assert found == status
    assert json.loads(content)["errors"]


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"material.Ktc": 1e9}, "out of range"),
        ({"tool.teeth": 2.5}, "not a whole number"),
        ({"material.Ktc": "600 MPa"}, "not a number"),
        ({"material.Ktc": True}, "not a number"),
        ({"structure.frf": 1}, "no slider"),
        ({"lobes.speeds.from": 25000, "lobes.speeds.to": 5000}, "not below"),
        ([1], "table"),
    ],
)
def test_values_out_of_bounds_are_told(server, values, said):
    for path in ("diagram", "simulation", "case"):
        point = {"spindle_speed_rpm": 2e4, "axial_depth_mm": 1.0}
        status, told = post(server, path, stage="coarse", values=values, **point)
        assert status == 422
        assert said in " ".join(told["errors"])


@pytest.mark.parametrize("point", [(1e9, 1.0), (2e4, 0.0), (2e4, 1e9), ("x", 1.0), (None, None)])
def test_points_off_the_diagram_are_told(server, point):
    given = {"spindle_speed_rpm": point[0], "axial_depth_mm": point[1]}
    status, told = post(server, "simulation", **given)
    assert status == 422
    assert told["errors"]


def test_not_a_number_is_refused(server):
    status, _, _ = call(server, "POST", "case", b'{"values": {"material.Ktc": NaN}}')
    assert status == 422


def test_a_newer_request_supersedes_an_older_one():
    latest, begun, outcome = NewestRequest(60.0), threading.Event(), []

    def endless(go_on):
        begun.set()
        while True:
            go_on()

    def older():
        try:
            latest.run("page", endless)
        except SupersededError:
            outcome.append("superseded")

    thread = threading.Thread(target=older)
    thread.start()
    assert begun.wait(10.0)
    assert latest.run("page", lambda go_on: "newer") == "newer"
    thread.join(10.0)
    assert outcome == ["superseded"]


def test_a_computation_without_end_is_given_up():
    def endless(go_on):
        while True:
            go_on()

    with pytest.raises(RunError, match="given up"):
        NewestRequest(0.05).run("page", endless)


def test_port_in_use_is_told(server):
    with pytest.raises(InputError, match="--port"):
        LiveServer(server.live, server.server_port)


def test_a_method_too_slow_is_told():
    with pytest.raises(InputError, match="--method"):
        LiveCase(chatter.load(CASE), "time-domain")


def cuts_of_the_examples():
    """Examples whose case is a cut of a structure."""
    cases = {path.parent.name: chatter.load(path) for path in EXAMPLES.glob("*/case.toml")}
    sections = ("tool", "material", "cut", "structure")
    return sorted(name for name, case in cases.items() if all(getattr(case, s) for s in sections))


@pytest.mark.parametrize("name", cuts_of_the_examples())
def test_every_slider_of_every_example_may_be_moved(name):
    case = chatter.load(EXAMPLES / name / "case.toml")
    for one in case_sliders(case):
        assert one.low <= one.value <= one.high
        for value in (one.low, one.value, one.high):
            # in steps of the slider, numbers are whole where they must be
            case.patch({one.path: one.text(round(value) if one.whole else value)})


def test_coarse_diagram_follows_the_boundary_that_the_fine_one_finds():
    live = LiveCase(chatter.load(CASE), "collocation")
    # one lobe, so that both have the same number of limits at every speed
    values = {"lobes.speeds.from": 15000.0, "lobes.speeds.to": 18000.0, "lobes.depths.to": 3.0}
    coarse, fine = (live.diagram(values, stage, lambda *_: None) for stage in ("coarse", "fine"))
    speeds = coarse["spindle_speed_rpm"]
    limits = [depths[0] for depths in fine["crossings_mm"] if depths]
    wanted = np.interp(
        speeds,
        [s for s, d in zip(fine["spindle_speed_rpm"], fine["crossings_mm"], strict=True) if d],
        limits,
    )
    compared = [
        depths[0] / limit
        for depths, limit in zip(coarse["crossings_mm"], wanted, strict=True)
        if depths
    ]
    assert len(compared) > 60
    assert max(abs(ratio - 1.0) for ratio in compared) < 0.01
    assert coarse["operating"]["stable"] == fine["operating"]["stable"]
    heard = [value for value in coarse["chatter_frequency_Hz"] if value is not None]
    assert all(900.0 < value < 1100.0 for value in heard)
