"""What the server answers, to whom, and the files that it hands out."""

import csv
import io
import json
import socket
import sys
import threading
import zipfile
from urllib.request import urlopen

import numpy as np
import pytest

import susp_ss as ss
from susp_ss.explorer.app import application
from susp_ss.explorer.compute import compute
from susp_ss.explorer.server import address, listening
from susp_ss.explorer.state import NOTHING, Given, from_query
from susp_ss.vehicles.files import read_vehicle

DESIGNS = {
    "ks_front=20000&arb_rear=8000&seat_x=0.2&speed=25": ss.FullCar(
        ks=ss.Corners.axles(front=20e3, rear=18553.0), arb_rear=8e3
    ).with_seats({"driver": ss.Seat(x=0.2, y=0.4)}),
    "model=roll-half&curve_rebound=1.5&speed=25": ss.RollHalfCar(
        cs=1516.5 * ss.DamperCurve([-0.2, -0.1, 0.0, 0.1, 0.2], [-0.225, -0.15, 0.0, 0.07, 0.105])
    ),
    "model=ride-handling&cornering_rear=60000&speed=25": ss.RideHandlingCar(
        cornering=ss.Corners.axles(front=45e3, rear=60e3), speed=25.0
    ),
    "model=three-axle&ks_middle=450000&arb_rear=200000&speed=25": ss.ThreeAxleTruck(
        ks=(250e3, 450e3, 550e3), arb_rear=200e3
    ),
}
ROAD = ss.Road.iso8608("B", speed=25.0, tracks="isotropic")


@pytest.fixture(scope="module")
def app():
    return application()


@pytest.fixture
def client(app):
    return app.server.test_client()


def asked(client, state, pins=()):
    """What the page is answered while its sliders move."""
    answer = client.post("/answer", json={"state": state, "pins": list(pins)})
    assert answer.status_code == 200
    return json.loads(answer.data)


def test_the_page_gets_what_is_computed(client):
    state, _ = from_query("model=quarter&ks=20000")
    assert asked(client, state) == {"found": compute(state), "pins": []}


def test_of_designs_to_compare_with_the_page_gets_what_it_draws(client):
    pins = [from_query(text)[0] for text in ("ks_front=30000", "model=quarter&seat_mass=60", "speed=40")]
    answers = asked(client, NOTHING.default(), pins)["pins"]
    for pin, found in zip(pins, answers, strict=True):
        assert len(json.dumps(found)) < len(json.dumps(compute(pin)))
        assert part(found, compute(pin))


def part(found, whole):
    """Whether everything of one answer is in another."""
    if isinstance(found, dict):
        return all(part(value, whole[key]) for key, value in found.items())
    if isinstance(found, list):
        return len(found) == len(whole) and all(map(part, found, whole))
    return found == whole


@pytest.mark.parametrize("question", [None, [], {"state": {}}, {"state": {}, "pins": {}}, {"pins": []}], ids=str)
def test_what_is_no_question_is_refused_in_one_line(client, question):
    answer = client.post("/answer", data=json.dumps(question), content_type="application/json")
    assert answer.status_code == 400
    assert answer.data.decode().startswith("question must be a mapping of a state and a list of pins, got")


def test_a_state_that_is_wrong_is_answered_in_words(client):
    found = asked(client, {"model": "quarter", "vehicle": {"ks": "__import__('os')"}})["found"]
    assert found["errors"][0]["message"].startswith("ks must be a number from")
    assert found["metrics"]


def test_two_users_do_not_meet(client):
    soft, hard = ({**NOTHING.default("quarter"), "vehicle": {"ks": ks}} for ks in (12e3, 40e3))
    first = asked(client, soft)
    assert asked(client, hard) != first
    assert asked(client, soft) == first


@pytest.mark.parametrize("host", ["localhost", "localhost:8050", "127.0.0.1:8050", "[::1]:8050"])
def test_this_machine_is_answered(client, host):
    assert client.get("/", headers={"Host": host}).status_code == 200


PATHS = ["/", "/_dash-layout", "/_dash-dependencies", "/download/csv", "/assets/none.js"]


@pytest.mark.parametrize("path", PATHS)
@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:8050", "127.0.0.1.evil.example", "192.168.1.7", "0.0.0.0"]
)
def test_another_name_is_refused_whatever_is_asked(client, path, host):
    assert client.get(path, headers={"Host": host}).status_code == 403


@pytest.mark.parametrize(
    "foreign",
    [
        {"Origin": "http://evil.example"},
        {"Origin": "http://localhost:9999"},
        {"Origin": "null"},
        {"Sec-Fetch-Site": "cross-site"},
        {"Sec-Fetch-Site": "same-site"},
    ],
    ids=str,
)
def test_a_page_of_another_origin_is_refused(client, foreign):
    for path in PATHS[1:]:
        assert client.get(path, headers=foreign).status_code == 403
    for path in ("/answer", "/background", "/_dash-update-component"):
        assert client.post(path, json={}, headers=foreign).status_code == 403


def test_a_link_from_elsewhere_leads_to_the_page(client):
    answer = client.get("/?ks_front=20000", headers={"Sec-Fetch-Site": "cross-site"})
    assert answer.status_code == 200
    assert "Access-Control-Allow-Origin" not in answer.headers
    assert answer.headers["X-Frame-Options"] == "DENY"


def test_the_page_loads_nothing_from_elsewhere(client):
    page = client.get("/").data.decode()
    for attribute in ("src=", "href="):
        for part in page.split(attribute)[1:]:
            assert part[1:].startswith("data:") or (part[1] == "/" and part[2] != "/")


def test_it_listens_on_this_machine_alone(app):
    with listening(app, 0) as server:
        assert server.socket.getsockname()[0] == "127.0.0.1"
        thread = threading.Thread(target=server.serve_forever)
        thread.start()
        try:
            with urlopen(address(server)) as answer:
                assert b"susp_ss explorer" in answer.read()
        finally:
            server.shutdown()
            thread.join()


@pytest.mark.parametrize("text", DESIGNS)
def test_lines_of_python_make_the_same_again(client, text):
    answer = client.get(f"/download/py?{text}")
    assert "explored.py" in answer.headers["Content-Disposition"]
    made = {}
    exec(answer.data.decode(), made)
    own = ss.ride_metrics(DESIGNS[text], ROAD)
    for name, data in made["metrics"].data_vars.items():
        assert data.values == pytest.approx(own[name].values, rel=1e-9)
    assert {"comfort", "response", "spectrum", "modes", "ride"} <= {*made}


@pytest.mark.parametrize("text", DESIGNS)
def test_a_vehicle_file_is_read_again(client, text, tmp_path):
    path = tmp_path / "car.toml"
    path.write_bytes(client.get(f"/download/toml?{text}").data)
    read, own = (ss.ride_metrics(car, ROAD) for car in (read_vehicle(path), DESIGNS[text]))
    for name, data in read.data_vars.items():
        assert data.values == pytest.approx(own[name].values, rel=1e-9)


def test_a_table_holds_every_metric(client):
    text = "model=quarter&ct=100"
    rows = list(csv.DictReader(io.StringIO(client.get(f"/download/csv?{text}").data.decode())))
    own = ss.ride_metrics(ss.QuarterCar(ct=100.0), ss.Road.iso8608("B", tracks="isotropic"))
    for row in rows:
        if row["name"] in own:
            assert float(row["value"]) == pytest.approx(float(own[row["name"]]), rel=1e-9)
            assert row["unit"] == own[row["name"]].attrs["units"]
    assert {*map(str, own)} <= {row["name"] for row in rows}
    assert np.isinf(float(next(row["value"] for row in rows if row["name"] == "dtl")))


@pytest.mark.filterwarnings("ignore:.*compiler")
def test_an_fmu_holds_the_vehicle(client, monkeypatch):
    monkeypatch.setattr("susp_ss.exchange.exporting.COMPILERS", ())
    data = client.get("/download/fmu?model=quarter&curve_knee=0.1").data
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        assert "bacc" in archive.read("modelDescription.xml").decode()


WRONG = {
    "/download/exe": (404, "no file of kind exe, available: csv, toml, fmu, py"),
    "/download/csv?ks_front=soft": (400, "ks_front must be a number from 5053 to 74553 N/m, got 'soft'"),
    "/download/py?model=boat": (
        400,
        "model must be one of full, quarter, pitch-half, roll-half, ride-handling, three-axle, got 'boat'",
    ),
}


@pytest.mark.parametrize(("path", "said"), WRONG.items())
def test_a_file_that_there_is_not_is_refused_in_one_line(client, path, said):
    answer = client.get(path)
    assert (answer.status_code, answer.data.decode()) == said


@pytest.mark.parametrize("kind", ["py", "toml"])
def test_a_system_has_no_parameters_to_write(kind):
    system = Given(ss.LinearVehicle(ss.QuarterCar().state_space()))
    answer = application(system).server.test_client().get(f"/download/{kind}")
    assert answer.status_code == 400
    assert answer.data.decode().startswith("the system of a file has no parameters")


def test_a_port_that_is_taken_is_refused(run):
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        ran = run("explore", "--no-browser", "--port", port)
    assert ran.code == 2
    assert ran.err.startswith(f"susp-ss: error: --port {port}: ")
    assert len(ran.err.splitlines()) == 1


@pytest.mark.parametrize(
    "arguments",
    [
        ("--vehicle", "none.toml"),
        ("--system", "none.json"),
        ("--road", "none.csv"),
        ("--surrogate", "none.json"),
        ("--port", "70000"),
        ("--port", "-1"),
    ],
    ids=" ".join,
)
def test_what_cannot_be_begun_with_is_refused_in_one_line(run, arguments):
    ran = run("explore", "--no-browser", *arguments)
    assert ran.code == 2
    assert len(ran.err.splitlines()) == 1


def test_dash_that_is_missing_is_said_with_the_command_that_installs_it(run, monkeypatch):
    monkeypatch.setitem(sys.modules, "dash", None)
    ran = run("explore", "--no-browser")
    assert ran.code == 2
    assert "The explorer needs dash, which is not installed" in ran.err
