"""Small SDF files, one rule of the format each."""

# ruff: noqa: E501 - each file in as few lines as can be

from __future__ import annotations

INERTIAL = "<inertial><mass>2</mass><inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia></inertial>"
TWO = f'<link name="a">{INERTIAL}</link><link name="b"><pose>1 2 3 0.1 0.2 0.3</pose>{INERTIAL}</link>'


def model(inside: str, version: str = "1.10") -> str:
    """A file with one model."""
    return f'<sdf version="{version}"><model name="m">{inside}</model></sdf>'


def joint(kind: str, inside: str = "", version: str = "1.10") -> str:
    """A file with two links and a joint between them."""
    return model(f'{TWO}<joint name="j" type="{kind}"><parent>a</parent><child>b</child>{inside}</joint>', version)


def shape(geometry: str, tag: str = "collision") -> str:
    """A file with one link that has a shape of this geometry."""
    return model(f'<link name="a">{INERTIAL}<{tag} name="s"><pose>0 0 1 0 0 0</pose><geometry>{geometry}</geometry></{tag}></link>')


AXIS = "<axis><xyz>0 1 0</xyz>{}</axis>"
LIMIT = "<limit><lower>-1</lower><upper>2</upper><effort>3</effort><velocity>4</velocity></limit>"
DYNAMICS = "<dynamics><damping>1</damping><friction>2</friction><spring_reference>3</spring_reference><spring_stiffness>4</spring_stiffness></dynamics>"

SAMPLES = {
    "a link without anything": model('<link name="a"/>'),
    "poses of all kinds": model(
        '<pose>1 0 0 0 0 0</pose><link name="a"><pose degrees="true">0 0 0 90 0 45</pose></link>'
        '<link name="b"><pose relative_to="a" rotation_format="quat_xyzw">1 0 0 0 0 0.6 0.8</pose></link><link name="c"><pose/></link>'
    ),
    "frames": model(
        f'{TWO}<frame name="f" attached_to="b"><pose>0 1 0 0 0 0</pose></frame><frame name="g"><pose relative_to="f"/></frame>'
    ),
    "placement frame": (
        f'<sdf version="1.10"><model name="m" placement_frame="b" canonical_link="b"><pose>0 0 5 0 0 0</pose>{TWO}</model></sdf>'
    ),
    "revolute": joint("revolute", AXIS.format(LIMIT + DYNAMICS)),
    "revolute without limits": joint("revolute", AXIS.format("<limit><lower>-1e16</lower><upper>inf</upper><effort>-1</effort></limit>")),
    "continuous": joint("continuous", AXIS.format("")),
    "prismatic in another frame": joint("prismatic", '<pose relative_to="a"/><axis><xyz expressed_in="__model__">0 3 4</xyz></axis>'),
    "fixed": joint("fixed"),
    "ball": joint("ball"),
    "screw": joint("screw", f"<screw_thread_pitch>0.5</screw_thread_pitch>{AXIS.format('')}"),
    "old screw": joint("screw", f"<thread_pitch>3</thread_pitch>{AXIS.format('')}", "1.6"),
    "universal": joint("universal", "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2>"),
    "revolute2": joint("revolute2", "<axis><xyz>1 0 0</xyz></axis><axis2><xyz>0 0 1</xyz></axis2>"),
    "gearbox": joint("gearbox", f"<gearbox_ratio>2</gearbox_ratio>{AXIS.format('')}"),
    "a gearbox between hinges": model(
        f'{TWO}<link name="c"/><joint name="j" type="revolute"><parent>a</parent><child>b</child>{AXIS.format("")}</joint>'
        f'<joint name="k" type="continuous"><parent>a</parent><child>c</child>{AXIS.format(DYNAMICS)}</joint>'
        '<joint name="l" type="gearbox"><parent>b</parent><child>c</child><gearbox_reference_body>a</gearbox_reference_body>'
        '<gearbox_ratio>3</gearbox_ratio><axis><xyz expressed_in="b">0 1 0</xyz></axis><axis2><xyz>0 1 0</xyz></axis2></joint>'
    ),
    "the model's axis in an old file": joint(
        "revolute", "<axis><xyz>0 0 1</xyz><use_parent_model_frame>1</use_parent_model_frame></axis>", "1.6"
    ),
    "mimic": model(
        f'{TWO}<link name="c"/><joint name="j" type="continuous"><parent>a</parent><child>b</child>{AXIS.format("")}</joint>'
        f'<joint name="k" type="continuous"><parent>b</parent><child>c</child>'
        + AXIS.format('<mimic joint="j"><multiplier>2</multiplier><offset>1</offset><reference>0.5</reference></mimic>')
        + "</joint>",
        "1.11",
    ),
    "a loop": model(
        f'{TWO}<link name="c"/><joint name="j" type="fixed"><parent>a</parent><child>b</child></joint>'
        '<joint name="k" type="ball"><parent>b</parent><child>c</child></joint>'
        f'<joint name="l" type="revolute"><parent>a</parent><child>c</child>{AXIS.format("")}</joint>'
    ),
    "a joint to the world": model(
        f'<link name="a">{INERTIAL}</link><joint name="j" type="fixed"><parent>world</parent><child>a</child></joint>'
    ),
    "a joint between frames": model(
        f'{TWO}<frame name="f" attached_to="b"><pose>0 1 0 0 0 0</pose></frame>'
        '<joint name="j" type="fixed"><parent>a</parent><child>f</child></joint>'
    ),
    "a nested model": model(
        f'<link name="a"/><model name="n"><pose relative_to="a">1 0 0 0 0 0</pose>{TWO}</model>'
        '<joint name="j" type="fixed"><parent>a</parent><child>n::b</child></joint>'
    ),
    "static": model(f"<static>true</static>{TWO}"),
    "a world": (
        '<sdf version="1.9"><world name="w"><gravity>0 0 -9.8</gravity><model name="p"><static>1</static><link name="l"/></model>'
        '<model name="r"><pose>0 0 1 0 0 0</pose><link name="l"/></model><physics type="ode"><max_step_size>0.01</max_step_size></physics>'
        '<light name="sun" type="directional"><pose>0 0 10 0 0 0</pose><diffuse>1 1 1 1</diffuse><direction>0 1 -1</direction></light></world></sdf>'
    ),
    "one model in a world": f'<sdf version="1.8"><world name="w"><frame name="f" attached_to="m::b"/><model name="m">{TWO}</model></world></sdf>',
    "box": shape("<box><size>1 2 3</size></box>"),
    "sphere": shape("<sphere><radius>1</radius></sphere>"),
    "cylinder": shape("<cylinder><radius>1</radius><length>2</length></cylinder>"),
    "capsule": shape("<capsule><radius>1</radius><length>2</length></capsule>"),
    "ellipsoid": shape("<ellipsoid><radii>1 2 3</radii></ellipsoid>"),
    "plane": shape("<plane><normal>0 1 0</normal><size>3 4</size></plane>"),
    "mesh": shape("<mesh><uri>a.stl</uri><submesh><name>s</name></submesh><scale>1 2 3</scale></mesh>"),
    "cone": shape("<cone><radius>1</radius><length>2</length></cone>"),
    "polyline": shape("<polyline><point>0 0</point><point>0 1</point><point>1 0</point><height>1</height></polyline>"),
    "heightmap": shape("<heightmap><uri>a.png</uri><size>1 2 3</size></heightmap>"),
    "geometry that is empty": model(
        '<link name="a"><visual name="v"><geometry/></visual><collision name="c"><geometry/></collision></link>'
    ),
    "contact": model(
        f'<link name="a">{INERTIAL}<collision name="c"><geometry><empty/></geometry><surface><friction><ode><mu>0.5</mu><mu2>0.4</mu2></ode>'
        "</friction><contact><ode><kp>1e5</kp></ode></contact></surface></collision></link>"
    ),
    "material": model(
        '<link name="a"><visual name="visual"><geometry><sphere><radius>1</radius></sphere></geometry><material><ambient>1 0 0 1</ambient>'
        "<diffuse>1 0.5 0 1</diffuse><pbr><metal><albedo_map>a.png</albedo_map><metalness>0.25</metalness></metal></pbr></material></visual></link>"
    ),
    "ambient colour": model(
        '<link name="a"><visual name="v"><geometry><sphere><radius>1</radius></sphere></geometry><material><diffuse>1 0.50 0</diffuse>'
        '<ambient>1 0.50 0</ambient></material></visual><visual name="w"><geometry><sphere><radius>1</radius></sphere></geometry><material>'
        '<ambient my:kind="x" xmlns:my="urn:my">1 0 0 1</ambient><diffuse>1 0 0 1</diffuse><specular>1 1 1 1</specular></material></visual></link>'
    ),
    "an only model without links in a world": (
        '<sdf version="1.9"><world name="w"><model name="m"><plugin name="p" filename="libp.so"/></model></world></sdf>'
    ),
    "sensors": model(
        '<link name="a"><sensor name="i" type="imu"><update_rate>100</update_rate><imu><enable_orientation>false</enable_orientation></imu></sensor>'
        '<sensor name="c" type="camera"><pose>0 0 1 0 0 0</pose><camera><horizontal_fov>1.2</horizontal_fov><image><width>640</width>'
        "<height>480</height></image><clip><near>0.1</near><far>10</far></clip></camera></sensor></link>"
    ),
    "auto inertia": model(
        '<link name="a"><inertial auto="true"><density>500</density></inertial><collision name="c"><density>600</density><geometry><box>'
        "<size>1 2 3</size></box></geometry></collision></link>",
        "1.11",
    ),
    "plugins and custom elements": model(
        '<link name="a"/><plugin name="p" filename="libp.so"><gain>2</gain></plugin><my:note xmlns:my="urn:my" my:kind="x">words</my:note>'
    ),
    "added mass": model(
        '<link name="a"><inertial><pose>0 0 1 0 0 0.5</pose><mass>3</mass><inertia><ixx>2</ixx><ixy>0.1</ixy><iyy>2</iyy><izz>2</izz></inertia>'
        "<fluid_added_mass><xx>1</xx></fluid_added_mass></inertial></link>"
    ),
}
"""Each is accepted by libsdformat, and says something of its own."""
