"""Why each code has the severity that it has: `hymeko-x explain CODE` prints it, and a test demands it of every code that is used.

The measure is whether the result is what the author of the input meant. An error: it is not, or nothing tells whether it is; the
command ends and writes nothing. A warning: something is odd, is read by a rule that other programs do not share, or gets lost in this
output, and everything else is what was meant. A note: all is well, and this is how it was done. Where one code has several severities,
each is given with the case in which it applies.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from hymeko_x import codes
from hymeko_x.diagnostics import Severity

if TYPE_CHECKING:
    from collections.abc import Iterator, Mapping

    from hymeko_x.diagnostics import Code

_NOTHING_READ = "without it there is nothing to go on with"
_NOT_MEANT = "what is used instead is not what the author wrote"
_REFUSED = "the program that the format belongs to refuses it as well"

ERRORS: Mapping[Code, str] = {
    codes.CANNOT_READ: f"{_NOTHING_READ}; a layer of a stage that cannot be read is a missing part of the robot",
    codes.CANNOT_WRITE: "what was asked for is not there",
    codes.UNKNOWN_TARGET: "nothing tells what the output is for",
    codes.UNKNOWN_FORMAT: "reading a text by the rules of another format gives a wrong robot or none",
    codes.NOT_XML: _NOTHING_READ,
    codes.WRONG_ROOT: _NOTHING_READ,
    codes.NOT_JSON: _NOTHING_READ,
    codes.BAD_DOCUMENT: _NOTHING_READ,
    codes.TOO_LARGE: "reading goes no further, so that the rest would be missing",
    codes.ENTITIES: "without expanding them their content would be missing",
    codes.NOT_WELL_FORMED: "nothing tells how much of the robot is missing",
    codes.BAD_NUMBER: f"{_NOT_MEANT}: a pose, a mass or a limit is wrong",
    codes.MISSING_ATTRIBUTE: "a shape without its size or a joint without its type is not what the author meant",
    codes.BAD_NAME: "what has no name cannot be referred to, or was meant to have another one",
    codes.DUPLICATE_NAME: "references to the name mean one of the two, and nothing tells which",
    codes.LEFTOVER_TEMPLATE: "the text stands for a number or for elements that are missing here",
    codes.ZERO_AXIS: f"{_NOT_MEANT}: the joint moves in another direction, or in none",
    codes.UNKNOWN_WORD: f"{_NOT_MEANT}: a joint of an unknown type does not move",
    codes.UNDEFINED_REFERENCE: "what it leads to is missing: a link, a prim, a part of a stage",
    codes.TWO_PARENTS: "the place of the body in the tree is not certain: readers choose different joints",
    codes.CYCLE: "the bodies have no place in any tree",
    codes.MISSING_PART: "a joint without its ends cannot be placed, and a robot without links is none",
    codes.REPEATED: _REFUSED,
    codes.EXPANSION_FAILED: _NOTHING_READ,
    codes.ARGUMENT_MISSING: _NOTHING_READ,
    codes.PACKAGE_NOT_FOUND: "what the package holds would be missing",
    codes.INCLUDE_NOT_FOUND: "what the file holds would be missing",
    codes.EXPANSION_LIMIT: _NOTHING_READ,
    codes.NOT_URDF: _NOTHING_READ,
    codes.LIBRARY_MESSAGE: "the file itself, or the library, calls its result wrong",
    codes.ENVIRONMENT_CLOSED: "the variable has no default, so that its value would be missing",
    codes.FORBIDDEN_EXPRESSION: "the value of the expression would be missing",
    codes.SYNTAX: _NOTHING_READ,
    codes.UNKNOWN_TYPE: "nothing tells what the element is",
    codes.BAD_VALUE: f"{_NOT_MEANT}, or there is no default at all",
    codes.BAD_TEMPLATE: "what the template stands for would be missing",
    codes.BAD_EXPRESSION: "the value would be missing",
    codes.CIRCULAR_VALUE: "none of the values is known",
    codes.NOT_A_ROBOT: "the target is for robots, and there is none in the text",
    codes.ASSET_NOT_FOUND: "a layer of a stage is a part of the robot, with its bodies and joints",
    codes.ASSET_UNREADABLE: "the damaged mesh stands in the file itself, so that the file is damaged",
    codes.PACKAGE_UNAVAILABLE: _NOTHING_READ,
    codes.OFFLINE: _NOTHING_READ,
    codes.PACKAGE_UNKNOWN: _NOTHING_READ,
    codes.PACKAGE_DAMAGED: "files that are not the published ones prove nothing",
    codes.ENGINE_MISSING: "without the engine the question has no answer, or masses that it computes are missing",
    codes.ENGINE_REFUSED: "without the engine's reading the question has no answer, or masses that it computes are missing",
    codes.NO_CHAIN: "there is nothing to print",
    codes.CONFIG: "without it there is nothing to compare",
    codes.NOT_REPRESENTED: "the format has no element at all for what the whole file is about",
    codes.EMPTY_ROBOT: "there is nothing to simulate, to show or to compute",
    codes.LOOSE_JOINT: "the joint cannot be placed",
    codes.WRONG_COUNT: "the author declared other numbers",
    codes.BAD_LIMITS: "no position fulfils such limits, and no engine agrees on a negative bound",
    codes.NO_INERTIA: "simulators refuse it or divide by zero",
    codes.BAD_MASS: "no body has such a mass",
    codes.BAD_TENSOR: "no body has such a tensor; simulators refuse it or explode",
    codes.NO_VISUAL: "with --profile complete every link has a visual shape",
    codes.NO_COLLISION: "with --profile complete every link has a collision shape",
    codes.BAD_SIZE: "no shape has such a size",
    codes.LIBRARY_MISSING: "what needs the library cannot be done without it",
    codes.NO_DYNAMICS: "there are no equations",
    codes.BAD_UNITS: "the numbers would be added without meaning",
    codes.MASSLESS: "the equations divide by the mass",
    codes.ALGEBRAIC_LOOP: "the equations have no order in which they can be computed",
    codes.SINGULAR_MASS: "some acceleration is not determined",
    codes.BAD_NETWORK: "nothing tells what is connected with what",
    codes.BAD_SIGNAL: "nothing tells what the input is",
    codes.NO_FORM: "there is nothing to print",
    codes.SIMULATION_FAILED: "there is no result from there on",
    codes.NOTHING_TO_DRAW: "there is no picture",
    codes.CANNOT_DRAW: "there is no picture",
    codes.BUG: "the result cannot be trusted",
    codes.EDIT_DROPPED: "with the edits the original would not be read again; it stays as it is",
}
"""Why it ends the command."""

WARNINGS: Mapping[Code, str] = {
    codes.WRONG_ROOT: "the root of SDF before 1.3 is read as its own rules convert it, and other programs refuse the file",
    codes.REPAIRED_XML: "every element and attribute is there as it was written; other readers overlook the mistake, or refuse the file",
    codes.ENGINE_REFUSED: "the output is complete; what only the engine finds out about it is not in it",
    codes.NO_FORM: "the equations are those of what they cover",
    codes.PASSED_OVER: "the user allowed it, and has to remember",
    codes.BAD_NUMBER: "one number as a scale means the same in all directions",
    codes.MISSING_ATTRIBUTE: "the default is the format's own, or the value stays unspecified; a mesh without a file is as one not found",
    codes.BAD_NAME: "nothing refers to a robot, a material, a transmission or an actuator without a name",
    codes.DUPLICATE_NAME: "both definitions are the same, or nothing refers to them by name",
    codes.LEFTOVER_TEMPLATE: "a name is a name, and those that refer to it have the same text",
    codes.UNKNOWN_WORD: "the format ignores the element, or has a default for the word",
    codes.CONTRADICTION: "the one counts that the engines prefer; programs that know only the other one see another robot",
    codes.BAD_LIMIT: "the numbers are kept as they were written; `check` calls them wrong",
    codes.UNDEFINED_REFERENCE: "a mimic or an actuator without its target has no effect in any reader, and a parent 'world' is the world",
    codes.SEVERAL_ROOTS: "each tree is kept as it was written, and many formats allow several",
    codes.MISSING_LIMIT: "a joint without limits is unlimited, which is what most readers take it for",
    codes.MISSING_PART: "a shape without geometry is none, a missing mass stays unspecified, and a stage without bodies is a scene",
    codes.MATERIAL_REDEFINED: "both appearances are kept, and nothing but appearance depends on it",
    codes.REPEATED: "the first one counts, as in the format's reference reader",
    codes.BAD_MASS: "a file holds it, and what is done with the robot decides whether it matters",
    codes.BAD_TENSOR: "a file holds it, and what is done with the robot decides whether it matters",
    codes.PACKAGE_NOT_FOUND: "a folder of nearly the same name has the file that is asked for",
    codes.NOT_URDF: "the error about the missing links follows",
    codes.LIBRARY_MESSAGE: "the library says the same to its own users, and goes on",
    codes.ARGUMENT_UNKNOWN: "the file is expanded as it is without that argument",
    codes.UNKNOWN_TYPE: "the element is kept as it is, and the rest is what was meant",
    codes.BAD_VALUE: "the part of the value that has a meaning is used",
    codes.REWRITTEN: "the output is nearly the same robot; the message tells the difference",
    codes.RENAMED: "references follow, but programs that know the old name do not find it",
    codes.INERTIA_REPAIRED: "the engine would refuse the robot as it is; the message gives the change",
    codes.NOT_REPRESENTED: "the input is in order; this output cannot represent a part of it, which the list of losses shows",
    codes.RESIDUE_UNREADABLE: "what the file says in its own words is read completely",
    codes.ASSET_NOT_FOUND: "the reference is kept; the robot moves and weighs the same without the file",
    codes.ASSET_UNREADABLE: "the reference is kept; the robot moves and weighs the same without the file",
    codes.ASSET_NOT_WRITTEN: "the main file is complete; it refers to files that are not beside it",
    codes.READ_BESIDE: "the robot itself is read completely",
    codes.BAD_LIMITS: "such limits are possible, and mostly a mistake",
    codes.NO_VISUAL: "links without a visual shape are usual, and cannot be seen",
    codes.NO_COLLISION: "links without a collision shape are usual, and cannot be touched",
    codes.BAD_SIZE: "such a size is possible, and mostly a mistake of units",
    codes.COM_OUTSIDE: "such a centre is possible, and mostly a mistake of frames or units",
    codes.NOT_UNIT: "the direction is what counts, and it is the same",
    codes.UNSTABLE_INPUT: "an unstable system is one, and its response is what it is",
    codes.EDIT_DROPPED: "all other edits are there",
    codes.RESIDUE_SUPERSEDED: "the edited file counts, and the original that is kept for it is not used",
    codes.EDIT_REWRITTEN: "the edit is there, and more lines of the text are new than it needed",
}
"""Why it does not, although something is odd."""

NOTES: Mapping[Code, str] = {
    codes.NOT_UNIT: "a direction has no length, and the numbers are kept",
    codes.UNKNOWN_WORD: "other programs allow the word, and it is kept",
    codes.EDIT_REWRITTEN: "the edit is there, in an element that was printed anew",
    codes.EDIT_DROPPED: "the original's format makes the name itself, and the robot is the same",
    codes.OPTIONS_FOUND: "they explain the edited file best",
    codes.REWRITTEN: "the output is the same robot in other words",
    codes.REPAIRED: "it was asked for, and each repair is in the list",
    codes.SHARED_NAME: "the format allows it, and most programs look them up in tables of their own",
    codes.LATE_LEADER: "the format allows it, and only programs that couple the joints while they build the tree refuse it",
    codes.READ_BESIDE: "it belongs to the robot",
    codes.FOR_TARGET: "it was asked for, and belongs to the robot from then on",
    codes.RENAMED: "references follow, and the name was no name in the target",
    codes.INERTIA_REPAIRED: "the change is below what matters, or the body never moves by itself",
    codes.NOT_REPRESENTED: "only appearance or a hint for other programs is concerned",
    codes.RESIDUE_SUPERSEDED: "the newer change wins, as it should",
    codes.KEPT_USED: "it is what --keep kept",
    codes.KEPT_LEFT: "the output has all of its own words, and --keep takes it along",
    codes.RESIDUE_FOLLOWED: "everything was found again",
    codes.LIBRARY_MESSAGE: "the file prints it for its users",
    codes.ENVIRONMENT_CLOSED: "the file has a default for it",
    codes.ASSET_NOT_FOUND: "the reference is kept as it is in the source",
    codes.ASSET_CONVERTED: "the surface is the same in another type of file",
    codes.NORMALS_TURNED: "the surface is as in the source; only its shading is concerned",
    codes.ASSETS_APART: "everything is written; only the folder is another one",
}
"""Why there is nothing to worry about."""


def reasons(code: Code) -> Iterator[tuple[Severity, str]]:
    """Each severity that a code can have, with its reason; the worst first."""
    for severity, table in ((Severity.ERROR, ERRORS), (Severity.WARNING, WARNINGS), (Severity.NOTE, NOTES)):
        if code in table:
            yield severity, table[code]
