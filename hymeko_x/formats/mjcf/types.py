"""What the values of MJCF's attributes may be, which attributes an element needs, and which ones exclude each other. Data only.

Source: MuJoCo 4.0 itself, asked about every attribute; `tests/mjcf/test_mjcf_values.py` asks it again.
"""

from __future__ import annotations

from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

from msgspec import Struct

from hymeko_x.formats.mjcf.schema import attributes_of

if TYPE_CHECKING:
    from collections.abc import Mapping

_ANY = 10**9

# A kind, and the attributes of it: by name, or as PLACE@NAME where the same name means something else elsewhere.
# 3: three numbers; 1-3: one to three; n: any number of numbers; int: whole ones; a|b: one of these words; *a|b: some of them.
_TYPES = """\
1: accel actuatorlength actuatortendon actuatorwidth adhesion alpha area armature azimuth boundinertia boundmass
  bulbradius ccd_tolerance coef com connect contactheight contactwidth cranklength cutoff dampratio delay density
  diameter divisor elevation emission exponent extent fitscale fogend fogstart force forcewidth fovy fpmax framelength
  framewidth frictionloss frustum fvmax gain gap glow gravcomp haze imax impratio inflate inheritrange intensity
  inttotal ipd jointlength jointwidth ki kp kv light linewidth lmax lmin ls_tolerance margin mass massscale maxforce
  meaninertia meanmass meansize metallic noise noslip_tolerance o_margin poisson prm radius random realtime ref
  reflectance resistance roughness selectpoint settotalmass shadowclip shadowscale shear shininess sleep_tolerance
  slewmax slidercrank softness solmix springref springyield stiffnessrot tausmooth thickness time timeconst timestep
  tolerance tolrange torque torquescale viscosity vmax young zfar znear actuator/muscle@scale asset/material@specular
  body/light@range compiler/lengthrange@interval default/light@range default/material@specular default/muscle@scale
  default/tendon@width deformable/flex/edge@damping deformable/flex/edge@stiffness deformable/flex/elasticity@damping
  tendon/spatial@width visual/map@stiffness visual/scale@camera visual/scale@constraint
1-10: biasprm dynprm gainprm
1-2: inductance interval motorconst o_solref solref solreffriction solreflimit springlength yield
1-3: cogging damping friction nominal saturation size stiffness body/frame@scale
1-5: fluidcoef lugre o_friction o_solimp polycoef solimp solimpfriction solimplimit contact/pair@friction
  default/pair@friction
1-6: controller gear surfacevel thermal
2: actrange actuatorfrcrange ctrlrange ffrange focal focalpixel forcerange lengthrange posrange principal principalpixel
  range sectionsize sensorsize springdamper texrepeat velrange actuator/muscle@timeconst default/muscle@timeconst
3: ambient anchor attenuation axis bias bindpos cell center diaginertia diffuse dir euler gravity magnetic markrgb
  offset pos refpos rgb1 rgb2 scale specular wind zaxis
4: actuatornegative actuatorpositive axisangle bindquat bv contactforce contactfriction contactgap contactpoint
  contacttorque crankbroken fog quat rangefinder refquat rgba asset/hfield@size visual/rgba@actuator
  visual/rgba@bvactive visual/rgba@camera visual/rgba@com visual/rgba@connect visual/rgba@constraint visual/rgba@force
  visual/rgba@frustum visual/rgba@haze visual/rgba@inertia visual/rgba@joint visual/rgba@light visual/rgba@selectpoint
  visual/rgba@slidercrank
6: fromto fullinertia xyaxes
7: relpose
int 1: actdim activelayers cameraid ccd_iterations conaffinity condim contype count dim group height iterations
  ls_iterations maxhullvert nchannel ncol nconmax njmax nkey noslip_iterations nrow nsample nstack num numquads
  numslices numstacks nuser_actuator nuser_body nuser_cam nuser_geom nuser_jnt nuser_sensor nuser_site nuser_tendon
  nuserdata offheight offsamples offwidth priority sdf_initpoints sdf_iterations shadowsize width custom/numeric@size
int 2: gridsize inertiagrouprange resolution
int 3: cellcount
int n: actuatorgroupdisable element elemtexcoord face vertid
n: act ctrl mpos mquat nodecoord normal plastic qpos qvel texcoord user vertex vertweight asset/hfield@elevation custom/numeric@data
text: asset/mesh@builtin custom/text@data custom/tuple/element@objtype sensor/plugin@objtype
  sensor/user@objtype
*angvel|dist|force|found|linvel|normal|pos|tangent|torque: sensor/contact@data
*depth|dir|dist|normal|origin|point: data
*depth|distance|normal|rgb|segmentation: output
2d|cube|skybox: asset/texture@type default/texture@type
2d|full|quadratic|radial|trilinear: dof
CG|Newton|PGS: solver
Euler|RK4|discrete|implicit|implicitfast: integrator
acc|none|pos|vel: needstage
affine|dcmotor|fixed|muscle|pid|so3|user: gaintype
affine|dcmotor|muscle|none|so3|user: biastype
allowed|auto|init|never: body@sleep
all|muscle|muscleuser|none: compiler/lengthrange@mode
auto|bvh|narrow|none|sap: selfcollide
auto|dense|sparse: jacobian
auto|false: fuse simple
auto|false|true: actlimited actuatorfrclimited align ctrllimited embed forcelimited inertiafromgeom limited
auto|false|true|0|1|2: visual/headlight@active
auto|linear|sRGB: colorspace
axis|positive|quaternion|real: datatype
ball|free|hinge|slide: body/joint@type default/joint@type
bend|both|none|stretch: elastic2d
body|camera|geom|site|xbody: objtype
box|capsule|cylinder|ellipsoid|hfield|mesh|plane|sdf|sphere: type
box|circle: section
convex|exact|legacy|shell: inertia
cross|edge|none|random: mark
cubic|linear|zoh: interp
dcmotor|filter|filterexact|integrator|muscle|none|pid|user: dyntype
degree|radian: angle
directional|image|point|spot: body/light@type default/light@type
disable|enable: actuation autoreset clampctrl constraint contact damper diagexact energy equality eulerdamp filterparent
  fwdinv invdiscrete ipc island limit midphase multiccd nativeccd override refsafe sensor sleep speculative spring
  warmstart option/flag@frictionloss option/flag@gravity
ellipsoid|none: fluidshape
elliptic|pyramidal: cone
error|merge|warning: conflict
false|true: actearly active actuatorgravcomp alignfree autolimits balanceinertia bvactive castshadow directional
  discardvisual ellipsoidinertia enclosed fitaabb flatskin fusestatic hflip mocap orthographic passive savecanonical
  savecompiled saveinertial shellinertia smoothnormal strippath texuniform useexisting uselimit usethread vflip
fixed|targetbody|targetbodycom|track|trackcom: mode
geometry|similar: scaling
global|local: coordinate
maxforce|mindist|netforce|none: reduce
none|textures: passthrough
orthographic|perspective: projection
checker|flat|gradient|none: builtin
"""

_REQUIRED = """\
role texture: default/material/layer asset/material/layer
plugin: extension/plugin
name: extension/plugin/instance custom/numeric custom/text custom/tuple
key value: extension/plugin/instance/config asset/mesh/plugin/config body/geom/plugin/config body/plugin/config
  actuator/plugin/config sensor/plugin/config
size: asset/hfield
bindpos bindquat body vertid vertweight: asset/skin/bone deformable/skin/bone
mass pos: body/inertial
body element: deformable/flex
body1 body2: contact/exclude
site: tendon/spatial/site sensor/touch sensor/accelerometer sensor/velocimeter sensor/gyro sensor/force sensor/torque
  sensor/magnetometer
geom: tendon/spatial/geom
divisor: tendon/spatial/pulley
coef joint: tendon/fixed/joint
joint1: equality/joint
tendon1: equality/tendon
flex: equality/flex equality/flexstrain
camera site: sensor/camprojection
joint: sensor/jointpos sensor/jointvel sensor/jointactuatorfrc sensor/ballquat sensor/ballangvel sensor/jointlimitpos
  sensor/jointlimitvel sensor/jointlimitfrc
tendon: sensor/tendonpos sensor/tendonvel sensor/tendonactuatorfrc sensor/tendonlimitpos sensor/tendonlimitvel
  sensor/tendonlimitfrc
actuator: sensor/actuatorpos sensor/actuatorvel sensor/actuatorfrc
objname objtype: sensor/framepos sensor/framequat sensor/framexaxis sensor/frameyaxis sensor/framezaxis
  sensor/framelinvel sensor/frameangvel sensor/framelinacc sensor/frameangacc custom/tuple/element
body: sensor/subtreecom sensor/subtreelinvel sensor/subtreeangmom
objname objtype site: sensor/insidesite
geom mesh: sensor/tactile
dim: sensor/user
"""

_FILLED = """\
maxhullvert: asset/mesh default/mesh
group: body/freejoint
size: custom/numeric
num: sensor/contact
dim: sensor/user
nconmax njmax nstack: size
"""

_EXCLUSIVE = """\
geom1 body1: sensor/distance sensor/normal sensor/fromto
geom2 body2: sensor/distance sensor/normal sensor/fromto
geom1 body1 subtree1 site: sensor/contact
geom2 body2 subtree2: sensor/contact
site camera: sensor/rangefinder
site1 body1: equality/connect equality/weld
site1 body2: equality/connect equality/weld
site1 anchor: equality/connect equality/weld
fullinertia diaginertia: body/inertial
"""


class Kind(Struct, frozen=True):
    """What a value is: ``least`` to ``most`` numbers (``whole`` or not), or one of ``words`` (``several``: some of them)."""

    least: int = 0
    most: int = 0
    whole: bool = False
    words: frozenset[str] = frozenset()
    several: bool = False

    def __str__(self) -> str:
        if self.words:
            return f"{'some' if self.several else 'one'} of {', '.join(sorted(self.words))}"
        count = "" if self.most == _ANY else f"{self.least} " if self.least == self.most else f"{self.least} to {self.most} "
        return f"{count}{'whole ' if self.whole else ''}number{'s' if self.most > 1 else ''}"


def _kind(text: str) -> Kind | None:
    if text == "text":
        return None
    if text[0] == "*":
        return Kind(words=frozenset(text[1:].split("|")), several=True)
    if "|" in text:
        return Kind(words=frozenset(text.split("|")))
    whole, text = text.startswith("int "), text.removeprefix("int ")
    if text == "n":
        return Kind(0, _ANY, whole)
    least, _, most = text.partition("-")
    return Kind(int(least), int(most or least), whole)


def _read(table: str) -> list[tuple[str, list[str]]]:
    """The lines of a table: what stands before the colon, and the words behind it."""
    joined = table.replace("\n  ", " ").splitlines()
    return [(head, rest.split()) for head, _, rest in (line.partition(": ") for line in joined)]


def _by_place(table: str) -> dict[str, list[tuple[str, ...]]]:
    found: dict[str, list[tuple[str, ...]]] = {}
    for names, places in _read(table):
        for place in places:
            found.setdefault(place, []).append(tuple(names.split()))
    return found


_KINDS: Mapping[str, Kind | None] = MappingProxyType({name: _kind(kind) for kind, names in _read(_TYPES) for name in names})

REQUIRED: Mapping[str, tuple[str, ...]] = MappingProxyType({place: names[0] for place, names in _by_place(_REQUIRED).items()})
"""The attributes that an element must have, by its place."""

FILLED: Mapping[str, tuple[str, ...]] = MappingProxyType({place: names[0] for place, names in _by_place(_FILLED).items()})
"""The numbers that may not be empty, by their element's place; MuJoCo takes all others for not being there then."""

EXCLUSIVE: Mapping[str, list[tuple[str, ...]]] = MappingProxyType(_by_place(_EXCLUSIVE))
"""The attributes of which an element may have one, by its place."""


@lru_cache(512)
def kinds_of(path: str) -> Mapping[str, Kind]:
    """The kinds of the attributes of the element of this place; those that are texts are not in it.

    What stands in <flexcomp> is for MuJoCo alone, and is read by it.
    """
    if path.startswith("body/flexcomp"):
        return MappingProxyType({})
    found = ((name, _KINDS.get(f"{path}@{name}", _KINDS.get(name))) for name in attributes_of(path))
    return MappingProxyType({name: kind for name, kind in found if kind is not None})
