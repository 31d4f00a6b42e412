"""Adapters to programs in any language."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from itertools import chain, combinations
from pathlib import Path

import jsonschema
import numpy as np
import pytest
from isograde.adapters import open_adapter
from isograde.adapters.exec import ExecAdapter
from isograde.adapters.protocol import check_json, form_of, protocol_schema
from isograde.claims import CLAIMS
from isograde.declaration import Declaration
from isograde.model import (
    CONTOURS,
    AdapterError,
    Limits,
    Outcome,
    Request,
    Status,
    Verdict,
)
from isograde.runner import Options, Worker, plan
from isoref.field import Field

FOREIGN = Path(__file__).with_name("foreign")
QUICK = Limits(seconds=5.0, megabytes=500)
# A shell that is ready, and that answers the request it read last by `say`.
READY = """read start; echo '{"protocol": 3}'; say() { id=${run#*'"id": '}
printf '{"id": %s, %s}\\n' "${id%%,*}" "$1"; }; """
TRIANGLE = '"vertices": [[0, 0, 0], [1, 0, 0], [0, 1, 0]], "simplices": [[0, 1, 2]]'


def ball(spacing: tuple[float, ...] = (1, 2, 3), origin: tuple[float, ...] = (9, 8, 7)) -> Field:
    """High in the middle of 5 x 6 x 7 samples."""
    i, j, k = np.indices((5, 6, 7))
    return Field.of(4 - (i - 2.1) ** 2 - (j - 2.4) ** 2 - (k - 3.2) ** 2, spacing, origin)


BALLS = [ball()] * 3


def ask(command: str, *fields: Field, limits: Limits = QUICK) -> tuple[Declaration, list[Outcome]]:
    """What the command declares, and its outcomes at isovalue 1."""
    adapter = open_adapter(f"exec:{command}")
    declared = adapter.open(limits)
    try:
        outcomes = [
            adapter.run(Request("test", "plain", field, (1.0,) * field.components))
            for field in fields or [ball()]
        ]
    finally:
        adapter.close()
    return declared, outcomes


@pytest.fixture(scope="module")
def tetrahedra(tmp_path_factory: pytest.TempPathFactory) -> str:
    """The command of the program in C, compiled."""
    compiler = shutil.which("cc")
    if compiler is None:
        pytest.skip("no C compiler here")
    program = tmp_path_factory.mktemp("foreign") / "tetrahedra"
    subprocess.run([compiler, "-O1", "-o", str(program), str(FOREIGN / "tetrahedra.c")], check=True)
    return shlex.quote(str(program))


def check_ball(outcome: Outcome, exact: float, rtol: float) -> None:
    """The outcome is the closed surface of `ball`, where it belongs, facing outwards."""
    import trimesh

    assert outcome.mesh is not None, outcome.detail
    solid = trimesh.Trimesh(outcome.mesh.vertices, outcome.mesh.simplices)
    assert solid.is_watertight
    assert solid.is_winding_consistent
    assert solid.volume == pytest.approx(exact, rtol)
    assert solid.center_mass == pytest.approx([11.1, 12.8, 16.6], abs=0.5)


def test_a_program_in_c_is_asked_through_files(tetrahedra: str) -> None:
    """Marching tetrahedra inscribe the ellipsoid of 4/3 pi r^3 within the coarseness."""
    declared, (outcome,) = ask(tetrahedra)
    assert (declared.name, declared.interpolant) == ("tetrahedra in C", "tetrahedra")
    check_ball(outcome, 6 * 4 / 3 * np.pi * 3**1.5, 0.3)


@pytest.mark.slow
def test_a_program_in_c_is_graded_watertight(tetrahedra: str) -> None:
    """Every claim of levels 0 and 1, on every sign pattern of a cell."""
    claims = tuple(name for name, claim in CLAIMS.items() if claim.level in (0, 1))
    only = Options(only=("cells/inside/*",), limits=QUICK)
    worker = Worker.open(f"exec:{tetrahedra}", only)
    try:
        tasks = plan(only, worker.cases, {name: worker.claims[name] for name in claims})
        judged = [worker.judge(task) for task in tasks]
    finally:
        worker.adapter.close()
    assert len(judged) == 256
    verdicts = [finding.verdict for one in judged for finding in one.findings.values()]
    assert set(verdicts) <= {Verdict.PASS, Verdict.SKIP}
    assert sum(verdict is Verdict.PASS for verdict in verdicts) > 5 * 256


def test_a_program_declines_what_it_does_not_read(tetrahedra: str) -> None:
    """It says so in its answer; what a declaration's limits refuse it would never see."""
    floats = Field.of(np.zeros((2, 2, 2), np.float32))
    _, outcomes = ask(tetrahedra, floats, ball())
    assert [o.status for o in outcomes] == [Status.DECLINED, Status.OK]


def test_the_form_of_an_answer_is_judged_as_all_forms_are() -> None:
    """To check one form is only faster: each allows its own keys alone, so nothing else changes."""
    values: dict[str, object] = {
        "id": 1, "vertices": [], "simplices": "s.npy", "faces": [], "polylines": [],
        "mesh": "m.ply", "answer": "a.json", "error": "no", "unsupported": "no", "seconds": 0.5,
        "other": 1,
    }  # fmt: skip
    right = 0
    for keys in chain.from_iterable(combinations(values, size) for size in range(5)):
        for wrong in (None, *keys[-1:]):
            said = {key: None if key == wrong else values[key] for key in keys}
            verdicts = []
            for part in ("answer", form_of(said)):
                try:
                    check_json(said, part, "it")
                    verdicts.append(True)
                except AdapterError:
                    verdicts.append(False)
            assert verdicts[0] == verdicts[1], said
            right += verdicts[0]
    assert right == 12  # Five forms with seconds or without, and two that took no time.


@pytest.mark.skipif(not shutil.which("awk") or not shutil.which("od"), reason="no awk or od here")
def test_a_shell_pipeline_is_an_implementation() -> None:
    """The blocks round the inside samples: one block a sample."""
    field = ball()
    inside = int((np.asarray(field.values, float) >= 1.0).sum())
    declared, (outcome,) = ask(f"sh {shlex.quote(str(FOREIGN / 'blocks.sh'))} | cat")
    assert declared.name == "blocks"
    check_ball(outcome, 6.0 * inside, 1e-12)


@pytest.mark.parametrize("suffix", [".ply", ".obj", ".off", ".stl"])
def test_a_mesh_file_of_any_format_is_an_answer(tmp_path: Path, suffix: str) -> None:
    import trimesh

    box = trimesh.creation.box()
    path = tmp_path / f"box{suffix}"
    box.export(path)
    answer = f'"mesh": {json.dumps(str(path))}'
    _, (outcome,) = ask(f"{READY} read run; say {shlex.quote(answer)}; read stop")
    assert outcome.mesh is not None, outcome.detail
    assert (len(outcome.mesh.vertices), len(outcome.mesh.simplices)) == (8, 12)


def test_arrays_may_stand_in_npy_files_or_in_the_line(tmp_path: Path) -> None:
    np.save(tmp_path / "v.npy", np.eye(3))
    np.save(tmp_path / "f.npy", [[0, 1, 2]])
    paths = f'"vertices": "{tmp_path / "v.npy"}", "simplices": "{tmp_path / "f.npy"}"'
    for answer in (paths, TRIANGLE):
        _, (outcome,) = ask(f"{READY} read run; say {shlex.quote(answer)}; read stop")
        assert outcome.mesh is not None, outcome.detail
        assert outcome.mesh.simplices.tolist() == [[0, 1, 2]]


@pytest.mark.parametrize(
    ("answer", "rows"),
    [
        ('"vertices": [], "simplices": []', []),
        ('"vertices": [], "faces": []', []),
        ('"vertices": [[0, 0, 0]], "faces": [[0, 0, 0]]', [[0, 0, 0]]),
        ('"vertices": [], "simplices": [[0, 1, 2, 3]]', [[0, 1, 2], [0, 2, 3]]),
        ('"vertices": [], "simplices": [[4, 5, 6], [0, 1, 2, 3]]',
         [[4, 5, 6], [0, 1, 2], [0, 2, 3]]),
    ],
)  # fmt: skip
def test_faces_and_polygons_are_answers(answer: str, rows: list[list[int]]) -> None:
    _, (outcome,) = ask(f"{READY} read run; say {shlex.quote(answer)}; read stop")
    assert outcome.status is Status.OK, outcome.detail
    assert outcome.simplices is not None
    assert outcome.simplices.shape == (len(rows), 3)
    assert outcome.simplices.tolist() == rows


PLANE = 'read start; echo \'{"protocol": 3, "declaration": {"limits": {"kinds": [[2, 1]]}}}\'; '


def test_polylines_are_an_answer_where_segments_are_asked_for() -> None:
    """A closed one repeats its first point, which does not become two vertices."""
    answer = '"polylines": [[[0, 0], [1, 0], [0, 1], [0, 0]], [[3, 3], [4, 4]]]'
    shell = PLANE + READY.partition("; ")[2].partition("; ")[2]
    _, (outcome, refused) = ask(
        f"{shell} read run; say {shlex.quote(answer)}; read stop", Field.of(np.eye(3)), ball()
    )
    mesh = outcome.mesh_of(CONTOURS)
    assert mesh is not None, outcome.detail
    assert mesh.simplices.tolist() == [[0, 1], [1, 2], [2, 0], [3, 4]]
    assert (refused.status, refused.detail) == (
        Status.DECLINED,
        "outside its limits: (n, m) = (3, 1)",
    )


def test_several_fields_stand_one_after_the_other(tmp_path: Path) -> None:
    """The shape has n numbers, the components their own, and the file an axis for them."""
    log, kept = tmp_path / "log", tmp_path / "kept.npy"
    find = 'sed \'s/.*"values": "\\([^"]*\\).*/\\1/\''
    shell = PLANE.replace("[2, 1]", "[3, 2]") + READY.partition("; ")[2].partition("; ")[2]
    command = (
        f'{shell} read run; echo "$run" > {shlex.quote(str(log))}; '
        f"cp $(echo $run | {find}) {shlex.quote(str(kept))}; say '\"polylines\": []'; read stop"
    )
    pair = Field.of(np.arange(48.0).reshape(2, 2, 3, 4), dimension=3)
    _, (outcome,) = ask(command, pair)
    assert outcome.status is Status.OK, outcome.detail
    said = json.loads(log.read_text())
    assert (said["shape"], said["components"], said["isovalues"]) == ([2, 3, 4], 2, [1.0, 1.0])
    assert np.array_equal(np.load(kept), pair.values)


@pytest.mark.parametrize(
    ("act", "status", "word"),
    [
        ("exit 3", Status.CRASH, "status 3"),
        ("echo oh no >&2; exit 3", Status.CRASH, "oh no"),
        ("kill -SEGV $$", Status.CRASH, "SIGSEGV"),
        ("sleep 60", Status.TIMEOUT, "0.5 s"),
        ("echo stuck >&2; sleep 60", Status.TIMEOUT, "stuck"),
        ("exec cat /dev/zero", Status.GARBAGE, "line"),
        ("yes progress", Status.GARBAGE, "progress"),
        ("echo 50 % done", Status.GARBAGE, "50 % done"),
        ("echo '[1, 2]'", Status.GARBAGE, "[1, 2]"),
        ("echo '{}'", Status.GARBAGE, "{}"),
        (
            "say '\"polylines\": [[[0, 0, 0], [1, 0, 0]]]'",
            Status.GARBAGE,
            "polylines are no answer",
        ),
        (
            'say \'"vertices": [[0, 0, 0]], "simplices": [[0, 0, 0, 0], [0, 0]]\'',
            Status.GARBAGE,
            "polygon 1 has 2 corners",
        ),
        ('say \'"vertices": [], "simplices": [], "faces": []\'', Status.GARBAGE, "not valid"),
        (f"echo '{{{TRIANGLE}}}'", Status.GARBAGE, "'id' is a required property"),
        ("run='\"id\": 1,'; say '" + TRIANGLE + "'", Status.GARBAGE, "answered request 1"),
        ('say \'"error": "no such field"\'', Status.RAISED, "no such field"),
        ('say \'"mesh": "absent.ply"\'', Status.GARBAGE, "absent.ply"),
        ('say \'"mesh": "values.npy"\'', Status.GARBAGE, "ends in"),
        ('say \'"vertices": "values.npy", "simplices": "/dev/zero"\'', Status.GARBAGE, "zero"),
        ('say \'"vertices": [["a"]], "simplices": []\'', Status.GARBAGE, "not real"),
        ("head -c 600000000 /dev/zero | tail -n 1 >&2; sleep 60", Status.MEMORY, "allowed"),
    ],
)
def test_each_ending_of_a_program_is_told_for_what_it_is(
    act: str, status: Status, word: str, tmp_path: Path
) -> None:
    """It misbehaves in the second call; the first and the third are sound."""
    count = shlex.quote(str(tmp_path / "count"))
    command = (
        f"{READY} while read run; do echo >> {count}; "
        f"if [ $(wc -l < {count}) = 2 ]; then {act}; else say '{TRIANGLE}'; fi; done"
    )
    limits = Limits(seconds=0.5 if status is Status.TIMEOUT else 20.0, megabytes=200)
    _, (before, bad, after) = ask(command, *[ball()] * 3, limits=limits)
    assert before.status is Status.OK, before.detail
    assert bad.status is status, bad.detail
    assert word in bad.detail
    assert after.status is Status.OK, after.detail


def test_a_line_too_many_is_garbage() -> None:
    """Whatever follows an answer cannot pass for the answer to the next request."""
    _, outcomes = ask(
        f"{READY} while read run; do say '{TRIANGLE}'; say '{TRIANGLE}'; done", *BALLS
    )
    assert Status.GARBAGE in {o.status for o in outcomes}
    for outcome in outcomes[1:]:
        told = "before the request" in outcome.detail or "when asked request" in outcome.detail
        assert told or outcome.status is Status.OK, outcome.detail


def test_an_answer_that_comes_late_cannot_pass_for_the_next_ones() -> None:
    """Each answer comes once more, after the next request was sent: the program is told apart."""
    late = f"""last=; while read run; do
        if [ "$last" ]; then sleep 0.1; next=$run; run=$last; say '{TRIANGLE}'; run=$next; fi
        say '{TRIANGLE}'; last=$run; done"""
    _, (first, second, third) = ask(READY + late, *BALLS)
    assert [o.status for o in (first, second, third)] == [
        Status.OK,
        Status.GARBAGE,
        Status.OK,  # of the program that was started again
    ]
    assert "it answered request 1 when asked request 2" in second.detail


def test_an_answer_after_the_time_limit_reaches_nobody() -> None:
    """The program is killed and started again, so the next request is met by another."""
    slow = (
        f"""n=0; while read run; do n=$((n + 1)); [ $n = 2 ] && sleep 1; say '{TRIANGLE}'; done"""
    )
    limits = Limits(seconds=0.5, megabytes=500)
    _, outcomes = ask(READY + slow, *BALLS, limits=limits)
    assert [o.status for o in outcomes] == [Status.OK, Status.TIMEOUT, Status.OK]


def test_a_request_can_be_read_with_scanf(tmp_path: Path) -> None:
    """Protocol: the keys in this order, with one blank after each colon and comma."""
    log = tmp_path / "log"
    ask(f"{READY} read run; echo \"$run\" > {shlex.quote(str(log))}; say '{TRIANGLE}'", ball())
    assert re.fullmatch(
        r'\{"command": "run", "id": 1, "dtype": "<f8", "shape": \[5, 6, 7\], "components": 1, '
        r'"spacing": \[1\.0, 2\.0, 3\.0\], "isovalues": \[1\.0\], "offset": 128, '
        r'"values": "[^"]*", "directory": "[^"]*", "case": "test"\}\n',
        log.read_text(),
    )


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("no-such-program-here", "not found"),
        ("exit 5", "status 5"),
        ("echo hello", "'hello'"),
        ("""echo '{"protocol": 4}'""", "3 was expected"),
        ("""echo '{"protocol": 1}'""", "each answer returns the id of its request"),
        ("""echo '{"protocol": 2}'""", "requests have isovalues and components"),
        ("echo '[]'", "is not an object"),
        (
            """echo '{"protocol": 3, "declaration": {"level": 9}}'""",
            "9 is no whole number from 0 to 4",
        ),
        (
            """echo '{"protocol": 3, "declaration": {"vertexes": "cells"}}'""",
            "no 'vertexes'; did you mean 'vertices'",
        ),
        (
            """echo '{"protocol": 3, "declaration": {"conventions": {"tie": "up"}}}'""",
            "tie: there is no 'up'",
        ),
    ],
)
def test_a_program_that_does_not_start_is_an_error_of_the_adapter(command: str, words: str) -> None:
    with pytest.raises(AdapterError, match=words):
        ask(command)


def test_every_message_follows_the_published_schema(tmp_path: Path) -> None:
    """Start, run and stop, as a program really receives them."""
    log = tmp_path / "log"
    echo = f"tee {shlex.quote(str(log))} | ({READY} while read run; do say '{TRIANGLE}'; done)"
    ask(echo, ball())
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    assert [line["command"] for line in lines] == ["start", "run", "stop"]
    for line in lines:
        definitions = protocol_schema()["$defs"]
        schema = {**definitions[line["command"]], "$defs": definitions}
        jsonschema.validate(line, schema)


def test_samples_are_written_little_endian_in_c_order(tmp_path: Path) -> None:
    """Whatever the array looks like in memory."""
    kept = shlex.quote(str(tmp_path / "kept.npy"))
    find = 'sed \'s/.*"values": "\\([^"]*\\).*/\\1/\''
    command = f"{READY} read run; cp $(echo $run | {find}) {kept}; say '{TRIANGLE}'; read stop"
    values = np.arange(24, dtype=">i2").reshape(4, 3, 2).T
    ask(command, Field.of(values))
    stored = np.load(tmp_path / "kept.npy")
    assert stored.flags.c_contiguous
    assert stored.dtype.str == "<i2"
    assert np.array_equal(stored, values)


def test_nothing_stays_behind() -> None:
    adapter = ExecAdapter(f"exec:{shlex.quote(sys.executable)} -c pass")
    directory = adapter.exchange.path
    assert directory.is_dir()
    del adapter
    assert not directory.exists()


def test_answers_may_go_by_a_descriptor_of_their_own() -> None:
    """`exec:program 3>&1 1>&2`: whatever it prints to standard output is for people."""
    sound = f"{READY.replace('echo', 'echo >&3').replace('printf', 'printf >&3')}"
    body = f"echo hello; {sound} read run; echo working; say '{TRIANGLE}'; read stop"
    _, (outcome,) = ask(f"sh -c {shlex.quote(body)} 3>&1 1>&2")
    assert outcome.mesh is not None, outcome.detail


def test_an_answer_may_stand_in_a_json_file() -> None:
    find = 'sed \'s/.*"directory": "\\([^"]*\\).*/\\1/\''
    answer = f"echo '{{{TRIANGLE}}}' > $(echo \"$run\" | {find})/a.json"
    _, (outcome,) = ask(f'{READY} read run; {answer}; say \'"answer": "a.json"\'; read stop')
    assert outcome.mesh is not None, outcome.detail


def test_a_bare_nan_is_told_with_its_place_and_what_to_write() -> None:
    """Issue 12: "not JSON at column 37: nan; write null"."""
    wrong = '"vertices": [[0, 0, nan]], "simplices": []'
    _, (outcome,) = ask(f"{READY} read run; say '{wrong}'; read stop")
    assert outcome.status is Status.GARBAGE
    assert "not JSON at column 31: nan; write null" in outcome.detail


@pytest.mark.parametrize("level", [float("nan"), float("inf"), -float("inf")])
def test_an_isovalue_that_is_no_number_is_sent_as_json(level: float, tmp_path: Path) -> None:
    """Strict JSON in both directions."""
    log = tmp_path / "log"
    adapter = open_adapter(
        f'exec:{READY} read run; echo "$run" > {shlex.quote(str(log))}; say \'"error": "no"\''
    )
    adapter.open(QUICK)
    adapter.run(Request("test", "isovalue-nan", ball(), (level,)))
    adapter.close()

    def refuse(word: str) -> None:
        raise AssertionError(word)

    said = json.loads(log.read_text(), parse_constant=refuse)
    definitions = protocol_schema()["$defs"]
    jsonschema.validate(said, {**definitions["run"], "$defs": definitions})
    assert str(level).lower()[:3] in said["isovalues"][0].lower()


def test_number_types_that_are_sent_are_listed() -> None:
    """Issue 12: number types listed in the schema; bool, (u)int of 1 to 8 bytes, floats."""
    listed = protocol_schema()["$defs"]["run"]["properties"]["dtype"]["enum"]
    kinds = {np.dtype(one).name for one in listed}
    assert len(kinds) == len(listed) == 12
    assert {"bool", "uint8", "int64", "float16", "float64"} <= kinds
