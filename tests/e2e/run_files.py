"""What a run leaves, and what its files must hold."""
import re

from harness import *

TRACE = (
    'time_s,x_m,y_m,z_m,qx,qy,qz,qw,force_x_N,force_y_N,force_z_N,torque_x_Nm,torque_y_Nm,torque_z_Nm,'
    'response_force_x_N,response_force_y_N,response_force_z_N,response_torque_x_Nm,response_torque_y_Nm,response_torque_z_Nm,'
    'result_age_ticks,contact,stage'
)
SUMMARY = [
    'real_time',
    'static_triangles',
    'tool_triangles',
    'backend',
    'device',
    'profile',
    'law',
    'ticks',
    'missed_ticks',
    'lateness_us',
    'result_age_ticks',
    'frame_us',
    'stages_reached',
    'areas_max',
    'force_max_N',
    'torque_max_Nm',
    'lateness_histogram_us',
    'result_age_histogram_ticks',
    'stopped',
    'coarse_frames',
    'no_direction_frames',
    'provenance',
]


def run(scene, out, *arguments):
    outcome = palpate('run', scene, '--pace', 'asap', '--overwrite', '--out', out, *arguments)
    expect(outcome.code == 0, outcome)
    return outcome


def frames(out):
    return [json.loads(line) for line in (out / 'frames.jsonl').read_text().splitlines()]


def without_time(line):
    return re.sub(r'"time_us":\{[^}]*\}', '', line)


def expect_same_files(one, two):
    expect((one / 'trace.csv').read_bytes() == (two / 'trace.csv').read_bytes(), 'trace.csv differs')
    first, second = ((d / 'frames.jsonl').read_text().splitlines() for d in (one, two))
    expect(
        len(first) == len(second) and all(without_time(x) == without_time(y) for x, y in zip(first, second)),
        'frames.jsonl differs beyond times',
    )


def expect_contract(out):
    """Header, fields and their order, and what must agree between the files. Returns the summary."""
    trace = (out / 'trace.csv').read_text().splitlines()
    expect(trace[0].startswith(TRACE), trace[0])
    summary = json.loads((out / 'summary.json').read_text())
    expect(
        [key for key in summary if key not in ('notes', 'no_direction_first', 'parts', 'profile_changes')]
        == SUMMARY,
        list(summary),
    )
    touched = [
        frame for frame in map(json.loads, (out / 'frames.jsonl').read_text().splitlines()) if frame['cst']
    ]
    expect(
        bool(touched) == ('parts' in summary)
        and (not touched or all(summary['parts'][body] for body in ('static', 'tool'))),
        summary.get('parts'),
    )
    expect(list(summary['lateness_us']) == ['p50', 'p99', 'p999', 'max'], summary['lateness_us'])
    expect(list(summary['result_age_ticks']) == list(summary['frame_us']) == ['p50', 'p99', 'max'], summary)
    expect(
        list(summary['real_time']) == ['kept_up', 'result_age_ticks', 'watchdog_ticks', 'sentence'],
        summary['real_time'],
    )
    expect(summary['ticks'] == len(trace) - 1 and summary['missed_ticks'] == 0, summary)
    # Virtual_delay_ticks 3, renewed every 3.
    expect(summary['result_age_ticks']['max'] <= 2 * 3, summary['result_age_ticks'])
    expect(summary['lateness_histogram_us'] == [], 'virtual time is never late')
    expect(
        sum(count for _, _, count in summary['result_age_histogram_ticks']) == summary['ticks'] - 3,
        summary['result_age_histogram_ticks'],
    )
    return summary
