"""Write the model of a robot, from a URDF or, with the package mujoco, an MJCF file.

Links become solids, joints become joints, each joint that moves gets a motor, which is an input.  Axes and
places are rounded to nine digits, and angles that are written for multiples of 15 deg are taken as these;
--exact keeps every digit.  The command names all that it does not import.
"""

import argparse

from lagc.cli.output import DONE, Usage, cannot_write, print_faults, print_json, say, show
from lagc.cli.signals import SIGNALS


def add_options(parser: argparse.ArgumentParser) -> None:
    parser.add_argument(
        "file", metavar="FILE", help="a URDF or MJCF file, or - for a URDF from standard input"
    )
    parser.add_argument("--free", action="store_true", help="let the root link of a URDF move freely")
    parser.add_argument("--exact", action="store_true", help="keep all digits")
    parser.add_argument(
        "-o", "--output", metavar="FILE", default="-", help="the file to write; - prints the model"
    )
    parser.add_argument("--force", action="store_true", help="replace an existing file")


def run(options: argparse.Namespace) -> int:
    from lagc.host import atomic_write
    from lagc.robots.read import robot_of
    from lagc.robots.text import model

    robot = robot_of(options.file, options.free, options.exact)
    text = model(robot, options.exact)
    if options.output != "-":
        try:
            with SIGNALS.patience():
                atomic_write.write(options.output, text.encode(), fresh=not options.force)
        except FileExistsError:
            raise Usage(f"`{options.output}` exists already; --force replaces it") from None
        except OSError as error:
            raise cannot_write(options.output, error) from None
    if options.json:
        facts = {"bodies": len(robot.bodies), "joints": len(robot.joints), "notes": robot.notes}
        warnings = [fault.message for fault in robot.warnings]
        print_json({"status": "ok", "file": options.output, **facts, "warnings": warnings,
                    **({"text": text} if options.output == "-" else {})})  # fmt: skip
        return DONE
    if robot.warnings and not options.quiet:
        print_faults(robot.warnings, color=False if options.no_color else None)
    if options.output == "-":
        show(text)
    else:
        for note in robot.notes:
            say(note, options.quiet)
        joints = f"{len(robot.bodies)} bodies and {len(robot.joints)} joints"
        say(
            f"{options.output} written, with {joints}; `lagc sim {options.output}` simulates it",
            options.quiet,
        )
    return DONE
