"""The elements and attributes that MuJoCo 4.0 knows, and what earlier versions knew. Data only.

Source: `mujoco.mj_printSchema`; `frame` and `replicate`, which it does not print, from the XML reference.
"""

from __future__ import annotations

from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

_SCHEMA = """\
mujoco: model
compiler: alignfree angle assetdir autolimits balanceinertia boundinertia boundmass conflict coordinate
  discardvisual eulerseq fitaabb fusestatic inertiafromgeom inertiagrouprange meshdir passthrough
  savecanonical savecompiled saveinertial settotalmass strippath texturedir usethread
compiler/lengthrange: accel interval inttotal maxforce mode timeconst timestep tolrange useexisting uselimit
option: actuatorgroupdisable ccd_iterations ccd_tolerance cone density gravity impratio integrator iterations
  jacobian ls_iterations ls_tolerance magnetic noslip_iterations noslip_tolerance o_friction o_margin o_solimp
  o_solref sdf_initpoints sdf_iterations sleep_tolerance solver timestep tolerance viscosity wind
option/flag: actuation autoreset clampctrl constraint contact damper diagexact energy equality eulerdamp
  filterparent frictionloss fwdinv gravity invdiscrete ipc island limit midphase multiccd nativeccd override
  refsafe sensor sleep speculative spring warmstart
size: memory nconmax njmax nkey nstack nuser_actuator nuser_body nuser_cam nuser_geom nuser_jnt nuser_sensor
  nuser_site nuser_tendon nuserdata
statistic: center extent meaninertia meanmass meansize
visual
visual/global: azimuth bvactive cameraid elevation ellipsoidinertia fovy glow ipd linewidth offheight offwidth
  orthographic realtime
visual/quality: numquads numslices numstacks offsamples shadowsize
visual/headlight: active ambient diffuse specular
visual/map: actuatortendon alpha fogend fogstart force haze shadowclip shadowscale stiffness stiffnessrot
  torque zfar znear
visual/scale: actuatorlength actuatorwidth camera com connect constraint contactheight contactwidth forcewidth
  framelength framewidth frustum jointlength jointwidth light selectpoint slidercrank
visual/rgba: actuator actuatornegative actuatorpositive bv bvactive camera com connect constraint contactforce
  contactfriction contactgap contactpoint contacttorque crankbroken fog force frustum haze inertia joint light
  rangefinder selectpoint slidercrank
default: class
default/mesh: inertia maxhullvert scale
default/texture: builtin colorspace embed gridlayout gridsize height hflip mark markrgb nchannel random rgb1
  rgb2 type vflip width
default/material: emission metallic reflectance rgba roughness shininess specular texrepeat texture texuniform
default/material/layer: role texture
default/joint: actuatorfrclimited actuatorfrcrange actuatorgravcomp armature axis damping frictionloss group
  limited margin pos range ref solimpfriction solimplimit solreffriction solreflimit springdamper springref
  springyield stiffness type user
default/geom: adhesion axisangle castshadow conaffinity condim contype density euler fitscale fluidcoef
  fluidshape friction fromto gap group hfield margin mass material mesh pos priority quat rgba shellinertia
  size solimp solmix solref surfacevel type user xyaxes zaxis
default/site: axisangle euler fromto group material mesh pos quat rgba size type user xyaxes zaxis
default/camera: axisangle euler focal focalpixel fovy ipd mode output pos principal principalpixel projection
  quat resolution sensorsize user xyaxes zaxis
default/light: active ambient attenuation bulbradius castshadow cutoff diffuse dir directional exponent
  intensity mode pos range softness specular type
default/pair: adhesion condim friction gap margin solimp solref solreffriction
default/equality: active solimp solref
default/tendon: actuatorfrclimited actuatorfrcrange armature damping frictionloss group limited margin
  material range rgba solimpfriction solimplimit solreffriction solreflimit springlength springyield stiffness
  user width
default/general: actdim actearly actlimited actrange armature biasprm biastype cranklength ctrllimited
  ctrlrange damping delay dynprm dyntype ffrange forcelimited forcerange gainprm gaintype gear group
  inheritrange input interp nsample user velrange
default/motor: armature cranklength ctrllimited ctrlrange damping delay forcelimited forcerange gear group
  interp nsample user
default/position: armature cranklength ctrllimited ctrlrange damping dampratio delay forcelimited forcerange
  gear group inheritrange interp kp kv nsample timeconst user
default/velocity: armature cranklength ctrllimited ctrlrange damping delay forcelimited forcerange gear group
  interp kv nsample user
default/intvelocity: actlimited actrange armature cranklength ctrllimited ctrlrange damping dampratio delay
  forcelimited forcerange gear group inheritrange interp kp kv nsample user
default/orientation: ctrlrange dampratio delay forcelimited forcerange group input interp kp kv nsample user
default/pid: armature cranklength ctrllimited ctrlrange damping dampratio delay ffrange forcelimited
  forcerange gear group imax inheritrange input interp ki kp kv nsample posrange slewmax user velrange
default/damper: armature cranklength ctrlrange damping delay forcelimited forcerange gear group interp kv
  nsample user
default/cylinder: area armature bias cranklength ctrllimited ctrlrange damping delay diameter forcelimited
  forcerange gear group interp nsample timeconst user
default/muscle: armature cranklength ctrllimited ctrlrange damping delay force forcelimited forcerange fpmax
  fvmax gear group interp lmax lmin nsample range scale timeconst user vmax
default/adhesion: ctrlrange delay forcelimited forcerange gain group interp nsample user
default/dcmotor: armature cogging controller cranklength ctrllimited ctrlrange damping delay gear group
  inductance input interp lugre motorconst nominal nsample resistance saturation thermal user
extension
extension/plugin: plugin
extension/plugin/instance: name
extension/plugin/instance/config: key value
asset
asset/mesh: builtin class content_type face file inertia material maxhullvert name normal params refpos
  refquat scale smoothnormal texcoord vertex
asset/mesh/plugin: instance plugin
asset/mesh/plugin/config: key value
asset/hfield: content_type elevation file name ncol nrow size
asset/skin: face file group inflate material name rgba texcoord vertex
asset/skin/bone: bindpos bindquat body vertid vertweight
asset/texture: builtin class colorspace content_type embed file fileback filedown filefront fileleft fileright
  fileup gridlayout gridsize height hflip mark markrgb name nchannel random rgb1 rgb2 type vflip width
asset/material: class emission metallic name reflectance rgba roughness shininess specular texrepeat texture
  texuniform
asset/material/layer: role texture
asset/model: content_type file name
body: axisangle childclass euler fuse gravcomp mocap name pos quat simple sleep user xyaxes zaxis
body/inertial: axisangle diaginertia euler fullinertia mass pos quat xyaxes zaxis
body/joint: actuatorfrclimited actuatorfrcrange actuatorgravcomp armature axis class damping frictionloss
  group limited margin name pos range ref solimpfriction solimplimit solreffriction solreflimit springdamper
  springref springyield stiffness type user
body/freejoint: align group name
body/geom: adhesion axisangle castshadow class conaffinity condim contype density euler fitscale fluidcoef
  fluidshape friction fromto gap group hfield margin mass material mesh name pos priority quat rgba
  shellinertia size solimp solmix solref surfacevel type user xyaxes zaxis
body/geom/plugin: instance plugin
body/geom/plugin/config: key value
body/attach: body frame model prefix
body/site: axisangle class euler fromto group material mesh name pos quat rgba size type user xyaxes zaxis
body/camera: axisangle class euler focal focalpixel fovy ipd mode name output pos principal principalpixel
  projection quat resolution sensorsize target user xyaxes zaxis
body/light: active ambient attenuation bulbradius castshadow class cutoff diffuse dir directional exponent
  intensity mode name pos range softness specular target texture type
body/plugin: instance plugin
body/plugin/config: key value
body/flexcomp: axisangle cellcount count dim dof element euler file flatskin group inertiabox mass material
  mesh name origin point pos quat radius rgba rigid scale spacing texcoord type xyaxes zaxis
body/flexcomp/edge: damping equality solimp solref stiffness
body/flexcomp/elasticity: damping elastic2d poisson section sectionsize shear thickness yield young
body/flexcomp/contact: activelayers conaffinity condim contype friction gap margin passive priority
  selfcollide solimp solmix solref
body/flexcomp/pin: grid gridrange id range
body/flexcomp/plugin: instance plugin
body/flexcomp/plugin/config: key value
deformable
deformable/flex: body cellcount dim dof element elemtexcoord flatskin group material name node nodecoord
  radius rgba texcoord vertex
deformable/flex/contact: activelayers conaffinity condim contype friction gap margin passive priority
  selfcollide solimp solmix solref
deformable/flex/edge: damping stiffness
deformable/flex/elasticity: damping elastic2d poisson section sectionsize shear thickness yield young
deformable/skin: face file group inflate material name rgba texcoord vertex
deformable/skin/bone: bindpos bindquat body vertid vertweight
contact
contact/pair: adhesion class condim friction gap geom1 geom2 margin name solimp solref solreffriction
contact/exclude: body1 body2 name
tendon
tendon/spatial: actuatorfrclimited actuatorfrcrange armature class damping frictionloss group limited margin
  material name range rgba solimpfriction solimplimit solreffriction solreflimit springlength springyield
  stiffness user width
tendon/spatial/site: site
tendon/spatial/geom: geom sidesite
tendon/spatial/pulley: divisor
tendon/fixed: actuatorfrclimited actuatorfrcrange armature class damping frictionloss group limited margin
  name range solimpfriction solimplimit solreffriction solreflimit springlength springyield stiffness user
tendon/fixed/joint: coef joint
equality
equality/connect: active anchor body1 body2 class name site1 site2 solimp solref
equality/weld: active anchor body1 body2 class name relpose site1 site2 solimp solref torquescale
equality/joint: active class joint1 joint2 name polycoef solimp solref
equality/tendon: active class name polycoef solimp solref tendon1 tendon2
equality/flex: active class flex name solimp solref
equality/flexstrain: active cell class flex name solimp solref
actuator
actuator/general: actdim actearly actlimited actrange armature biasprm biastype body class cranklength
  cranksite ctrllimited ctrlrange damping delay dynprm dyntype ffrange forcelimited forcerange gainprm
  gaintype gear group inheritrange input interp joint jointinparent lengthrange name nsample refsite site
  slidersite tendon user velrange
actuator/motor: armature class cranklength cranksite ctrllimited ctrlrange damping delay forcelimited
  forcerange gear group interp joint jointinparent lengthrange name nsample refsite site slidersite tendon
  user
actuator/position: armature class cranklength cranksite ctrllimited ctrlrange damping dampratio delay
  forcelimited forcerange gear group inheritrange interp joint jointinparent kp kv lengthrange name nsample
  refsite site slidersite tendon timeconst user
actuator/velocity: armature class cranklength cranksite ctrllimited ctrlrange damping delay forcelimited
  forcerange gear group interp joint jointinparent kv lengthrange name nsample refsite site slidersite tendon
  user
actuator/intvelocity: actlimited actrange armature class cranklength cranksite ctrllimited ctrlrange damping
  dampratio delay forcelimited forcerange gear group inheritrange interp joint jointinparent kp kv lengthrange
  name nsample refsite site slidersite tendon user
actuator/orientation: class ctrlrange dampratio delay forcelimited forcerange group input interp joint kp kv
  name nsample refsite site user
actuator/pid: armature class cranklength cranksite ctrllimited ctrlrange damping dampratio delay ffrange
  forcelimited forcerange gear group imax inheritrange input interp joint jointinparent ki kp kv lengthrange
  name nsample posrange refsite site slewmax slidersite tendon user velrange
actuator/damper: armature class cranklength cranksite ctrlrange damping delay forcelimited forcerange gear
  group interp joint jointinparent kv lengthrange name nsample refsite site slidersite tendon user
actuator/cylinder: area armature bias class cranklength cranksite ctrllimited ctrlrange damping delay diameter
  forcelimited forcerange gear group interp joint jointinparent lengthrange name nsample refsite site
  slidersite tendon timeconst user
actuator/muscle: armature class cranklength cranksite ctrllimited ctrlrange damping delay force forcelimited
  forcerange fpmax fvmax gear group interp joint jointinparent lengthrange lmax lmin name nsample range scale
  slidersite tausmooth tendon timeconst user vmax
actuator/adhesion: body class ctrlrange delay forcelimited forcerange gain group interp name nsample user
actuator/dcmotor: armature class cogging controller cranklength cranksite ctrllimited ctrlrange damping delay
  gear group inductance input interp joint jointinparent lengthrange lugre motorconst name nominal nsample
  refsite resistance saturation site slidersite tendon thermal user
actuator/plugin: actdim actearly actlimited actrange armature class cranklength cranksite ctrllimited
  ctrlrange damping delay dynprm dyntype forcelimited forcerange gear group instance interp joint
  jointinparent lengthrange name nsample plugin site slidersite tendon user
actuator/plugin/config: key value
sensor
sensor/touch: cutoff delay interp interval name noise nsample site user
sensor/accelerometer: cutoff delay interp interval name noise nsample site user
sensor/velocimeter: cutoff delay interp interval name noise nsample site user
sensor/gyro: cutoff delay interp interval name noise nsample site user
sensor/force: cutoff delay interp interval name noise nsample site user
sensor/torque: cutoff delay interp interval name noise nsample site user
sensor/magnetometer: cutoff delay interp interval name noise nsample site user
sensor/camprojection: camera cutoff delay interp interval name noise nsample site user
sensor/rangefinder: camera cutoff data delay interp interval name noise nsample site user
sensor/jointpos: cutoff delay interp interval joint name noise nsample user
sensor/jointvel: cutoff delay interp interval joint name noise nsample user
sensor/tendonpos: cutoff delay interp interval name noise nsample tendon user
sensor/tendonvel: cutoff delay interp interval name noise nsample tendon user
sensor/actuatorpos: actuator cutoff delay interp interval name noise nsample user
sensor/actuatorvel: actuator cutoff delay interp interval name noise nsample user
sensor/actuatorfrc: actuator cutoff delay interp interval name noise nsample user
sensor/jointactuatorfrc: cutoff delay interp interval joint name noise nsample user
sensor/tendonactuatorfrc: cutoff delay interp interval name noise nsample tendon user
sensor/ballquat: cutoff delay interp interval joint name noise nsample user
sensor/ballangvel: cutoff delay interp interval joint name noise nsample user
sensor/jointlimitpos: cutoff delay interp interval joint name noise nsample user
sensor/jointlimitvel: cutoff delay interp interval joint name noise nsample user
sensor/jointlimitfrc: cutoff delay interp interval joint name noise nsample user
sensor/tendonlimitpos: cutoff delay interp interval name noise nsample tendon user
sensor/tendonlimitvel: cutoff delay interp interval name noise nsample tendon user
sensor/tendonlimitfrc: cutoff delay interp interval name noise nsample tendon user
sensor/framepos: cutoff delay interp interval name noise nsample objname objtype refname reftype user
sensor/framequat: cutoff delay interp interval name noise nsample objname objtype refname reftype user
sensor/framexaxis: cutoff delay interp interval name noise nsample objname objtype refname reftype user
sensor/frameyaxis: cutoff delay interp interval name noise nsample objname objtype refname reftype user
sensor/framezaxis: cutoff delay interp interval name noise nsample objname objtype refname reftype user
sensor/framelinvel: cutoff delay interp interval name noise nsample objname objtype refname reftype user
sensor/frameangvel: cutoff delay interp interval name noise nsample objname objtype refname reftype user
sensor/framelinacc: cutoff delay interp interval name noise nsample objname objtype user
sensor/frameangacc: cutoff delay interp interval name noise nsample objname objtype user
sensor/subtreecom: body cutoff delay interp interval name noise nsample user
sensor/subtreelinvel: body cutoff delay interp interval name noise nsample user
sensor/subtreeangmom: body cutoff delay interp interval name noise nsample user
sensor/insidesite: cutoff delay enclosed interp interval name noise nsample objname objtype site user
sensor/distance: body1 body2 cutoff delay geom1 geom2 interp interval name noise nsample user
sensor/normal: body1 body2 cutoff delay geom1 geom2 interp interval name noise nsample user
sensor/fromto: body1 body2 cutoff delay geom1 geom2 interp interval name noise nsample user
sensor/contact: body1 body2 cutoff data delay geom1 geom2 interp interval name noise nsample num reduce site
  subtree1 subtree2 user
sensor/e_potential: cutoff delay interp interval name noise nsample user
sensor/e_kinetic: cutoff delay interp interval name noise nsample user
sensor/clock: cutoff delay interp interval name noise nsample user
sensor/tactile: cutoff delay geom interp interval mesh name nsample user
sensor/user: cutoff datatype dim name needstage noise objname objtype user
sensor/plugin: cutoff instance name objname objtype plugin refname reftype user
sensor/plugin/config: key value
custom
custom/numeric: data name size
custom/text: data name
custom/tuple: name
custom/tuple/element: objname objtype prm
keyframe
keyframe/key: act ctrl mpos mquat name plastic qpos qvel time
body/frame: axisangle childclass euler massscale name pos quat scale scaling xyaxes zaxis
body/replicate: count euler offset sep
"""


def _read_schema() -> dict[str, frozenset[str]]:
    found: dict[str, frozenset[str]] = {}
    path = ""
    for line in _SCHEMA.splitlines():
        head, _, rest = line.partition(": ") if not line.startswith(" ") else (path, "", line)
        path = head
        found[path] = found.get(path, frozenset()) | frozenset(rest.split())
    return found


_ATTRIBUTES: Mapping[str, frozenset[str]] = MappingProxyType(_read_schema())

_BODY_LIKE = ("body", "worldbody", "body/frame", "body/replicate")


def _children() -> dict[str, dict[str, str]]:
    found: dict[str, dict[str, str]] = {path: {} for path in (*_ATTRIBUTES, "worldbody")}
    for path in _ATTRIBUTES:
        parent, _, tag = path.rpartition("/")
        if path != "mujoco":
            found[parent or "mujoco"][tag] = path
    found["default"]["default"] = "default"
    for path in _BODY_LIKE:
        content = {tag: below for tag, below in found["body"].items() if path in ("body", "body/frame") or tag != "inertial"}
        found[path] = {**content, "body": "body", "frame": "body/frame", "replicate": "body/replicate"}
    found["mujoco"]["worldbody"] = "worldbody"
    return found


CHILDREN: Mapping[str, Mapping[str, str]] = MappingProxyType(_children())
"""For each element, by its place, the elements inside it with their places."""


@lru_cache(512)
def attributes_of(path: str) -> frozenset[str]:
    """The attributes of the element of this place."""
    return _ATTRIBUTES.get(path, frozenset())


REMOVED: Mapping[str, str] = MappingProxyType(
    {
        "composite": "<composite> was removed in MuJoCo 4.0: use <flexcomp> for cables, grids and cloth, <replicate> for rows of bodies",
        "equality/flexvert": "<flexvert> was removed in MuJoCo 4.0: use <flex>, or elasticity",
        "equality/distance": "the equality <distance> was removed in MuJoCo 2.2.2",
        "material/rgb": "textures of a material are <layer role=... texture=...> since MuJoCo 3.2.5",
        "option@collision": "option/collision was removed in MuJoCo 3.0: use contype, conaffinity, <pair> and <exclude>",
        "option@apirate": "option/apirate was removed in MuJoCo 3.3.7; it never changed the simulation",
        "option@mpr_iterations": "mpr_iterations is ccd_iterations since MuJoCo 3.2.3",
        "option@mpr_tolerance": "mpr_tolerance is ccd_tolerance since MuJoCo 3.2.3",
        "flag@passive": "the flag passive was split into spring and damper in MuJoCo 3.3.6",
        "flag@sensornoise": "the flag sensornoise was removed in MuJoCo 3.1.4; noise is added by whoever reads the sensor",
        "compiler@convexhull": "compiler/convexhull was removed in MuJoCo 3.2.5; hulls are always computed",
        "compiler@exactmeshinertia": 'compiler/exactmeshinertia is inertia="exact" of each <mesh> since MuJoCo 3.2.5',
        "camera@orthographic": 'camera/orthographic is projection="orthographic" since MuJoCo 3.5',
        "contact@internal": "flex/contact/internal was removed in MuJoCo 3.15: use selfcollide",
        "contact@vertcollide": "flex/contact/vertcollide was removed in MuJoCo 3.7",
        "contact@evpair": "flex/contact/evpair was removed in MuJoCo 3.15",
        "mujoco.elasticity.cable": 'the plugin was removed in MuJoCo 4.0: use <flexcomp dim="1"> with <elasticity>',
        "mujoco.elasticity.solid": 'the plugin was removed in MuJoCo 3.2.4: use <flexcomp dim="3"> with <elasticity>',
        "mujoco.elasticity.membrane": 'the plugin was removed in MuJoCo 3.2.4: use <flexcomp dim="2"> with <elasticity>',
        "mujoco.elasticity.shell": 'the plugin was removed in MuJoCo 3.3.3: use <flexcomp dim="2"> with <elasticity>',
    }
)
"""What changed about words that earlier versions had: ELEMENT or PARENT/ELEMENT, ELEMENT@ATTRIBUTE, and plugins by their names."""
