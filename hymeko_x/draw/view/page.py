"""The page of the viewer: the robots in three dimensions, sliders, layers, search, findings. The only file that knows viser.

Names of elements are never names of nodes, and reach the page as plain text or escaped.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from hymeko_x.draw.graph.letters import shown, visible
from hymeko_x.draw.view.scene import ellipsoid_of
from hymeko_x.ir.geometry import Box, Capsule, Cylinder, Ellipsoid, Plane, Sphere
from hymeko_x.verify.model import Kind
from hymeko_x.verify.spatial import quat_from_rotation
from hymeko_x.xml.text import escaped

if TYPE_CHECKING:
    from collections.abc import Callable, Iterable, Sequence

    import viser

    from hymeko_x.draw.view.findings import Spot
    from hymeko_x.draw.view.motion import Slider
    from hymeko_x.draw.view.scene import Item, Scene
    from hymeko_x.verify.model import Array, KinematicModel

    Handle = Any
    """What viser gives for a node or an element of the page."""

RED = (214, 39, 40)
LAYERS = ("visual", "collision", "frames", "axes", "inertia", "names")
_AXIS_COLOURS = {Kind.HINGE: (230, 120, 0), Kind.SLIDE: (0, 130, 90), Kind.SCREW: (150, 80, 200)}
_MOST_LISTED = 200
_WHITE = 205
"""The brightest colour: the page's lights make white parts of it."""
_APART = 1.4
"""The distance of two robots by the reach of the larger one."""
_DROP = """<style onload="
    window.ondragover = event => event.preventDefault();
    window.ondrop = event => {
        event.preventDefault();
        const input = document.querySelector('input[type=file]');
        if (!input || !event.dataTransfer.files.length) return;
        input.files = event.dataTransfer.files;
        input.dispatchEvent(new Event('change', {bubbles: true}));
    };
"></style>"""
"""Gives a file that is dropped on the page to the upload button. A script element would not run in text that is inserted later."""


class BodyNodes(NamedTuple):
    """The nodes of a body: the frame that is moved, and by layer what is fixed to it."""

    frame: Handle
    layers: dict[str, list[Handle]]


class ViewPage:
    """One page, which every browser that opens it shares.

    ``on_slider(number, value)`` is called when a user moves a slider, ``on_layout()`` when the two robots go to other places,
    ``on_file(name, content)`` when a user opens a file or drops it on the page.
    """

    def __init__(
        self,
        server: viser.ViserServer,
        on_slider: Callable[[int, float], None],
        on_layout: Callable[[], None],
        on_file: Callable[[str, bytes], None],
    ) -> None:
        self.server = server
        self.bodies: list[list[BodyNodes]] = []
        self.sliders: list[Handle] = []
        self.buttons: list[Handle] = []
        self._on_slider = on_slider
        self._models: list[KinematicModel] = []
        self._reach = 1.0
        self._is_setting = False
        gui = server.gui
        gui.configure_theme(show_logo=False, show_share_button=False)  # sharing goes through a server elsewhere
        gui.main_panel.dock_right()
        server.scene.set_up_direction("+z")
        server.scene.set_background_image(_sky())
        server.scene.configure_default_lights(cast_shadow=False)  # with shadows, or lit by an image of its surroundings, a frame takes
        server.scene.configure_environment_map(None)  # a browser without a graphics card 110 to 180 ms of processor time instead of 30
        server.scene.add_light_ambient("/light", intensity=1.2)
        self.problem = gui.add_html("", visible=False, order=0.0)
        self.upload = gui.add_upload_button("Compare with a file ...", hint="or drop a robot file on the page", order=0.5)
        self.upload.on_upload(lambda _: on_file(self.upload.value.name, self.upload.value.content))
        gui.add_html(_DROP)
        self.layers = {}
        with gui.add_folder("Show", order=1.0):
            for name in LAYERS:
                self.layers[name] = gui.add_checkbox(name, name == "visual")
                self.layers[name].on_update(lambda _: self._show_layers())
            self.layout = gui.add_button_group("two robots", ("side by side", "overlaid"), visible=False)
            self.layout.on_click(lambda _: on_layout())
        self.search = gui.add_text("Search", "", hint="a part of the name of a body or a joint", order=2.0)
        self.search.on_update(lambda _: self._search())
        self.found = gui.add_html("", order=3.0)
        self._folders: list[Handle] = []
        self._grid: Handle | None = None
        self._joints: Handle | None = None

    # ---- robots --------------------------------------------------------------------------------------------------------

    def show(self, scenes: Sequence[Scene], sliders: Sequence[Slider]) -> None:
        """Put robots in place of those that were there."""
        with self.server.atomic():
            for nodes in self.bodies:
                for body in nodes:
                    body.frame.remove()
            self._models = [scene.model for scene in scenes]
            self._reach = max(scene.reach for scene in scenes)
            self.bodies = [self._robot(number, scene) for number, scene in enumerate(scenes)]
            self.layout.visible = len(scenes) > 1
            self._show_layers()
            self._ground()
        self._show_sliders(sliders)
        camera = self.server.initial_camera
        middle = -0.5 * self.distance if len(scenes) > 1 else 0.0
        far = 0.65 * self._reach + 0.35 * abs(middle)
        camera.look_at = (0.0, middle, 0.5 * self._reach)
        camera.position = (2.2 * far, middle + 1.6 * far, 1.6 * far)

    @property
    def distance(self) -> float:
        """How far apart two robots are that stand side by side, in m."""
        return _APART * self._reach

    def overlay(self, *, is_overlaid: bool) -> None:
        """Make the second robot translucent where it is in the place of the first one."""
        for body in self.bodies[1] if len(self.bodies) > 1 else ():
            for handle in body.layers["visual"]:
                handle.opacity = 0.5 if is_overlaid else None

    def place(self, number: int, poses: Array, offset: Array) -> None:
        """Put the bodies of a robot to these poses (bodies, 4, 4), all moved by an offset in m."""
        quats = quat_from_rotation(poses[:, :3, :3])
        with self.server.atomic():
            for body, pose, quat in zip(self.bodies[number], poses, quats, strict=True):
                body.frame.position = pose[:3, 3] + offset
                body.frame.wxyz = quat

    def set_sliders(self, values: Sequence[float]) -> None:
        """Show where the joints really are."""
        self._is_setting = True
        for slider, value in zip(self.sliders, values, strict=True):
            if abs(slider.value - value) > 1e-9:
                slider.value = float(value)
        self._is_setting = False

    def fly_to(self, number: int, body: int) -> None:
        """Move every browser's camera to a body."""
        target = np.asarray(self.bodies[number][body].frame.position)
        for client in self.server.get_clients().values():
            with client.atomic():
                away = client.camera.position - client.camera.look_at
                length = max(float(np.linalg.norm(away)), 1e-9)
                client.camera.position = target + away * (0.8 * self._reach / length)
                client.camera.look_at = target

    # ---- words ---------------------------------------------------------------------------------------------------------

    def show_problem(self, words: str) -> None:
        """An error above everything else; none where the words are empty."""
        self.problem.content = f'<p style="color:#b3261e;padding:0 1em"><b>{_text(words)}</b></p>' if words else ""
        self.problem.visible = bool(words)

    def show_findings(self, answer: str, spots: Sequence[Spot], lists: Iterable[tuple[str, Sequence[str]]]) -> None:
        """The verdict, its differences as buttons, red at their bodies, and lists of lines that are folded."""
        for spot in spots:
            for number, bodies in enumerate(spot.bodies[: len(self.bodies)]):
                for body in bodies:
                    self._redden(number, body)
        for folder in self._folders:
            folder.remove()
        self.buttons = []
        gui = self.server.gui
        verdict = gui.add_folder(shown(answer), order=4.0)
        with verdict:
            for spot in spots[:_MOST_LISTED]:
                self._button(spot)
        self._folders = [verdict]
        for title, lines in lists:
            if lines:
                folder = gui.add_folder(title, expand_by_default=False, order=5.0)
                with folder:
                    gui.add_html(_list(lines))
                self._folders.append(folder)

    def _button(self, spot: Spot) -> None:
        button = self.server.gui.add_button(shown(spot.words), color="red", hint=spot.words)
        target = next(((number, body) for number in (1, 0) for body in spot.bodies[number]), None)
        if target is not None:
            button.on_click(lambda _: self.fly_to(*target))
        self.buttons.append(button)

    def _redden(self, number: int, body: int) -> None:
        layers = self.bodies[number][body].layers
        for handle in (*layers["visual"], *layers["collision"]):
            handle.color = RED
        self.bodies[number][body].frame.show_axes = True

    # ---- nodes ---------------------------------------------------------------------------------------------------------

    def _robot(self, number: int, scene: Scene) -> list[BodyNodes]:
        bodies = [self._body(number, index, scene.model) for index in range(len(scene.model.bodies))]
        for count, item in enumerate(scene.items):
            layer = "collision" if item.is_collision else "visual"
            handle = self._shape(f"/robot{number}/body{item.body}/shape{count}", item)
            if handle is not None:
                bodies[item.body].layers[layer].append(handle)
        return bodies

    def _body(self, number: int, index: int, model: KinematicModel) -> BodyNodes:
        """The frame of a body with its axes, its ellipsoid and its name."""
        path, size, scene = f"/robot{number}/body{index}", 0.12 * self._reach, self.server.scene
        frame = scene.add_frame(path, show_axes=False, axes_length=size, axes_radius=0.03 * size)
        layers: dict[str, list[Handle]] = {name: [] for name in LAYERS}
        for place, dof in enumerate(model.bodies[index].joint.dofs):
            if dof.kind in _AXIS_COLOURS:
                line = np.array([[dof.anchor - size * dof.axis, dof.anchor + size * dof.axis]], dtype=np.float32)
                layers["axes"].append(scene.add_line_segments(f"{path}/axis{place}", line, _AXIS_COLOURS[dof.kind], thickness=0.05 * size))
        ellipsoid = ellipsoid_of(model, index) if index else None
        if ellipsoid is not None:
            axes, turn, centre = ellipsoid
            scale = tuple(float(axis) for axis in axes)
            placed = {"wxyz": quat_from_rotation(turn[None])[0], "position": centre}
            layers["inertia"].append(
                scene.add_icosphere(f"{path}/inertia", 1.0, color=(150, 60, 200), opacity=0.4, scale=scale, **placed)  # type: ignore[arg-type]
            )
        if index:
            words = f"{shown(model.bodies[index].name or model.body_label(index))}  {model.bodies[index].mass:.4g} kg"
            layers["names"].append(scene.add_label(f"{path}/name", words))
        return BodyNodes(frame, layers)

    def _shape(self, path: str, item: Item) -> Handle | None:
        """The node of a shape; None where it is not drawn."""
        red, green, blue, alpha = item.rgba
        colour = (round(_WHITE * red), round(_WHITE * green), round(_WHITE * blue))
        appearance = {"color": colour, "opacity": alpha if alpha < 1.0 else None, "position": item.pose.xyz, "wxyz": item.pose.quat}
        scene: Any = self.server.scene
        match item.geometry:
            case Box(size):
                return scene.add_box(path, dimensions=size, **appearance)
            case Sphere(radius):
                return scene.add_icosphere(path, radius=radius, **appearance)
            case Cylinder(radius, length):
                return scene.add_cylinder(path, radius=radius, height=length, **appearance)
            case Capsule(radius, length):
                return scene.add_mesh_simple(path, *_capsule(radius, length), **appearance)
            case Ellipsoid(radii):
                return scene.add_icosphere(path, radius=1.0, scale=radii, **appearance)
            case Plane():
                return None
        if item.points is None or item.faces is None:
            return None
        return scene.add_mesh_simple(path, item.points.astype(np.float32), item.faces.astype(np.uint32), side="double", **appearance)

    def _ground(self) -> None:
        square = 10.0 ** round(np.log10(self._reach / 4.0))
        if self._grid is not None:
            self._grid.remove()
        side = 40.0 * square
        self._grid = self.server.scene.add_grid("/ground", width=side, height=side, cell_size=square, section_size=5 * square)

    def _show_layers(self) -> None:
        with self.server.atomic():
            for nodes in self.bodies:
                for body in nodes:
                    body.frame.show_axes = bool(self.layers["frames"].value)
                    for name, handles in body.layers.items():
                        for handle in handles:
                            handle.visible = bool(self.layers[name].value)

    # ---- the column at the side ------------------------------------------------------------------------------------------

    def _show_sliders(self, sliders: Sequence[Slider]) -> None:
        """New sliders, unless those that are there are the same."""
        labels = [f"{shown(slider.label)} [{slider.unit}]" for slider in sliders]
        ends = [(slider.lower, slider.upper) for slider in sliders]
        if [(handle.label, (handle.min, handle.max)) for handle in self.sliders] == list(zip(labels, ends, strict=True)):
            return
        if self._joints is not None:
            self._joints.remove()
        self._joints = self.server.gui.add_folder("Joints", order=6.0)
        with self._joints:
            reset = self.server.gui.add_button("rest")
            reset.on_click(lambda _: self._reset(sliders))
            self.sliders = [self._slider(number, slider, label) for number, (slider, label) in enumerate(zip(sliders, labels, strict=True))]

    def _slider(self, number: int, slider: Slider, label: str) -> Handle:
        step = max((slider.upper - slider.lower) / 1000.0, 1e-9)
        handle = self.server.gui.add_slider(label, slider.lower, slider.upper, step, slider.start, hint=visible(slider.label))
        handle.on_update(lambda _: None if self._is_setting else self._on_slider(number, float(handle.value)))
        return handle

    def _reset(self, sliders: Sequence[Slider]) -> None:
        for number, slider in enumerate(sliders):
            self._on_slider(number, slider.start)

    def _search(self) -> None:
        """List what has this in its name, and fly to the first of it."""
        word = self.search.value.casefold()
        hits = [
            (number, index)
            for number, model in enumerate(self._models)
            for index in range(1, len(model.bodies))
            if word and (word in (model.bodies[index].name or "").casefold() or word in (model.bodies[index].joint.name or "").casefold())
        ]
        lines = [self._about(number, index) for number, index in hits[:_MOST_LISTED]]
        self.found.content = _list(lines) if lines else _list([f"nothing is called '{visible(self.search.value)}'"]) if word else ""
        if hits:
            self.fly_to(*hits[0])

    def _about(self, number: int, index: int) -> str:
        """A body in a line: its name, mass and joint."""
        model, body = self._models[number], self._models[number].bodies[index]
        moves = ", ".join(dof.kind.value for dof in body.joint.dofs) or "fixed"
        letter = f"{'AB'[number]}: " if len(self._models) > 1 else ""
        return f"{letter}{model.body_label(index)}, {body.mass:.4g} kg, joint '{body.joint.name or ''}' ({moves})"


def _text(words: str) -> str:
    return escaped(visible(words))


def _list(lines: Iterable[str]) -> str:
    return f'<ul style="padding:0 1em 0 2em;overflow-wrap:anywhere">{"".join(f"<li>{_text(line)}</li>" for line in lines)}</ul>'


def _sky() -> Any:
    """A background that white robots differ from: a grey that becomes lighter towards the ground, (rows, 1, 3)."""
    rows = np.linspace(0.0, 1.0, 64)[:, None, None]
    return ((1.0 - rows) * (150, 165, 185) + rows * (210, 216, 224)).astype(np.uint8).repeat(64, axis=1)


def _capsule(radius: float, length: float, count: int = 24) -> tuple[Array, Any]:
    """The triangles of a capsule along z: rings from pole to pole."""
    angles = np.linspace(-np.pi / 2.0, np.pi / 2.0, count)
    heights = radius * np.sin(angles) + np.where(angles < 0.0, -0.5, 0.5) * length
    turns = np.linspace(0.0, 2.0 * np.pi, count, endpoint=False)
    across = radius * np.cos(angles)[:, None]
    points = np.stack([across * np.cos(turns), across * np.sin(turns), np.broadcast_to(heights[:, None], (count, count))], axis=-1)
    row, column = np.meshgrid(np.arange(count - 1), np.arange(count), indexing="ij")
    corner, right = row * count + column, row * count + (column + 1) % count
    faces = np.stack([np.stack([corner, right, right + count], -1), np.stack([corner, right + count, corner + count], -1)])
    return points.reshape(-1, 3).astype(np.float32), faces.reshape(-1, 3).astype(np.uint32)
