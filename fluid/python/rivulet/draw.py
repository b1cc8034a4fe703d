"""Drawing: cameras, light, and pictures as arrays."""
from __future__ import annotations

import ctypes
import dataclasses
from typing import Any, Sequence, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _structs as c
from ._handle import Handle
from ._library import BadInput, Error, address_of, array_of, each_of, number_of, of_kind, struct, vector, whole
from ._off_screen import OffScreen

Array = NDArray[Any]
_FOGS = {"exponential": 1, "exponential squared": 2, "linear": 3}
_BACKGROUND = (0.24, 0.26, 0.29), (0.07, 0.08, 0.10)  # sRGB, at the top and at the bottom: dark, so that reflections show the water's shape
_COLOURS = {"automatic": 0, "linear": 1, "sRGB": 2}


@dataclasses.dataclass
class Camera:
    """A perspective camera. eye, at: (3,) m, where it is and what is in the middle of the picture; fov: vertical angle of view, degrees; up:
    what is up in the picture; near, far: m along the view axis, what is seen."""

    eye: ArrayLike
    at: ArrayLike
    fov: float = 40.0
    up: ArrayLike = (0, 1, 0)
    near: float = 0.05
    far: float = 100.0

    def view(self, aspect: float) -> View:
        """Its matrices for a picture that is `aspect` times as wide as high. BadInput: the camera looks nowhere, or along `up`."""
        eye, at, up = (array_of(values, (3,), name, np.float64) for values, name in ((self.eye, "eye"), (self.at, "at"), (self.up, "up")))
        back = eye - at
        right = np.cross(up, back)
        if not np.linalg.norm(back) > 0 or not np.linalg.norm(right) > 1e-9 * np.linalg.norm(up) * np.linalg.norm(back):
            raise BadInput(f"the camera at {eye} looks at {at} with {up} upwards: choose others")
        fov, near, far = (number_of(value, name) for value, name in ((self.fov, "fov"), (self.near, "near"), (self.far, "far")))
        if not 0 < fov < 180 or not 0 < near < far:
            raise BadInput(f"fov is {self.fov}, near {self.near}, far {self.far}: give 0 < fov < 180 and 0 < near < far")
        axes = np.array([right / np.linalg.norm(right), np.cross(back, right) / np.linalg.norm(np.cross(back, right)), back / np.linalg.norm(back)])
        view = np.eye(4)
        view[:3, :3], view[:3, 3] = axes, -axes @ eye
        depth, slope = far - near, 1 / np.tan(np.radians(fov) / 2)
        projection = np.zeros((4, 4))
        projection[0, 0], projection[1, 1], projection[3, 2] = slope / aspect, slope, -1
        projection[2, 2:] = -(far + near) / depth, -2 * far * near / depth
        return View(view, projection, self.near, self.far)

    def distances(self, depths: ArrayLike) -> Array:
        """m along the view axis, of depths of a picture: 0 near .. 1 far."""
        return self.near * self.far / (self.far - np.asarray(depths, np.float64) * (self.far - self.near))

    def depths(self, distances: ArrayLike) -> Array:
        """Depths of a picture, 0 near .. 1 far, at distances (m along the view axis); beyond far: 1."""
        with np.errstate(divide="ignore"):
            depths = self.far / (self.far - self.near) * (1 - self.near / np.asarray(distances, np.float64))
        return np.clip(depths, 0, 1)


@dataclasses.dataclass
class View:
    """Matrices of the caller's own: view, world -> view, and projection, view -> clip space, both (4, 4) for columns, as mathematics writes
    them; any that rivulet_view of rivulet.h allows. near, far: m along the view axis."""

    view: ArrayLike
    projection: ArrayLike
    near: float
    far: float


@dataclasses.dataclass
class Light:
    """A light far away. direction: (3,), towards it, any length but 0; colour: (3,) radiance, 1 is white."""

    direction: ArrayLike
    colour: ArrayLike = (1, 1, 1)


@dataclasses.dataclass
class Fog:
    """The fog that the picture already contains: the water is seen through it too. kind: exponential, exponential squared or linear; colour:
    (3,) radiance, with `display` sRGB-encoded; density (1/m); start, end (m), of a linear one; along_view: distances are along the view
    axis, else from the eye; display: it is blended with sRGB-encoded values, else with linear ones."""

    kind: str
    colour: ArrayLike
    density: float = 0.0
    start: float = 0.0
    end: float = 0.0
    along_view: bool = False
    display: bool = False


@dataclasses.dataclass
class Shadow:
    """Where the first light is shaded. depths: (h, w), row 0 at the top: a picture's depth() as the light sees the scene, or the name of an
    OpenGL texture; projection: (4, 4), world -> the map's clip space; zero_to_one, reversed: conventions of these depths; bias: of stored
    depth."""

    depths: Union[ArrayLike, int]
    projection: ArrayLike
    zero_to_one: bool = False
    reversed: bool = False
    bias: float = 0.002


@dataclasses.dataclass
class Target:
    """A framebuffer of the caller's own OpenGL context (Context(find=...)): its OpenGL name, 0: the window; the part that is drawn into,
    pixels from the lower left corner; colours: automatic (linear in a framebuffer of floats, else sRGB), linear or sRGB."""

    framebuffer: int
    width: int
    height: int
    x: int = 0
    y: int = 0
    colours: str = "automatic"


def _default_background(size: tuple[int, int], linear: bool) -> Array:
    share = np.linspace(0, 1, size[0])[:, None, None]
    colours = (1 - share) * np.array(_BACKGROUND[0]) + share * np.array(_BACKGROUND[1])
    return np.broadcast_to(((colours + 0.055) / 1.055) ** 2.4 if linear else colours, (*size, 3))


class Picture:
    """Colour and depth off screen, into which worlds are drawn one after the other; made by Context.picture. Closed at the end of its `with`,
    by close(), or with the last reference."""

    def __init__(self, gl: OffScreen, width: int, height: int, linear: bool) -> None:
        self.width, self.height, self.linear, self._gl = whole(width, 1, 16384, "width"), whole(height, 1, 16384, "height"), linear, gl
        with gl:
            self._colour = _texture(gl, 0x8814 if linear else 0x8058, self.width, self.height)  # GL_RGBA32F, GL_RGBA8
            self._depth = _texture(gl, 0x8CAC, self.width, self.height)  # GL_DEPTH_COMPONENT32F
            name = ctypes.c_uint()
            gl.call("glCreateFramebuffers", "ip", 1, ctypes.addressof(name))
            self._framebuffer = name.value
            gl.call("glNamedFramebufferTexture", "iiii", name.value, 0x8CE0, self._colour, 0)
            gl.call("glNamedFramebufferTexture", "iiii", name.value, 0x8D00, self._depth, 0)
            complete = gl.call("glCheckNamedFramebufferStatus", "ii", name.value, 0x8D40, result=ctypes.c_uint) == 0x8CD5
        if not complete:
            self.close()
            raise Error(f"this machine's OpenGL has no room for a picture of {width} x {height}")

    def fill(self, background: ArrayLike | None = None, depth: ArrayLike = 1.0) -> None:
        """Replaces the whole picture. background: one colour of 3 or 4 values, or an image (h, w, 3 or 4), row 0 at the top: sRGB, 0 to 1 or
        uint8 of 0 to 255; of a linear picture linear radiance; None: dark grey, darker downwards. depth: 0 near .. 1 far, one or (h, w); see
        Camera.depths. Copied. BadInput: other values or shapes."""
        size, kind = (self.height, self.width), np.float32 if self.linear else np.uint8
        given = np.asarray(_default_background(size, self.linear) if background is None else background)
        if given.dtype == np.uint8 and self.linear:
            raise BadInput("the background is of bytes, and the picture is linear: give floats")
        if given.dtype != np.uint8:
            given = array_of(given, (-1,) * given.ndim, "the background")
            if not np.isfinite(given).all():
                raise BadInput("the background has a value that is not finite: replace it, for example with numpy.nan_to_num")
            if not self.linear:
                if given.min(initial=0) < 0 or given.max(initial=0) > 1:
                    raise BadInput(f"the background has values from {given.min():g} to {given.max():g}: give 0 to 1, or bytes, "
                                   "background.astype(numpy.uint8)")
                given = np.rint(given * 255).astype(np.uint8)
        if given.shape not in ((3,), (4,), (*size, 3), (*size, 4)):
            raise BadInput(f"the background has the shape {given.shape}: give a colour, (3,) or (4,), or an image, {size} + (3,) or (4,)")
        image = np.full((*size, 4), 1 if self.linear else 255, kind)
        image[..., :given.shape[-1]] = given
        depths = array_of(depth, (-1,) * np.ndim(depth), "the depth")
        if not ((depths >= 0) & (depths <= 1)).all():
            raise BadInput("the depth has values outside 0 to 1: use Camera.depths")
        if depths.shape not in ((), size):
            raise BadInput(f"the depth has the shape {depths.shape}: give one number or {size}")
        with self._current() as gl:
            _upload(gl, self._colour, image, 0x1908)  # GL_RGBA
            _upload(gl, self._depth, np.broadcast_to(depths, size), 0x1902)  # GL_DEPTH_COMPONENT

    def colour(self) -> Array:
        """(h, w, 4), row 0 at the top: uint8, sRGB; of a linear picture float32, linear radiance. A copy. Waits for the GPU."""
        with self._current() as gl:
            return download(gl, self._colour, (self.height, self.width, 4), np.float32 if self.linear else np.uint8, 0x1908)

    def depth(self) -> Array:
        """(h, w) float32, row 0 at the top: 0 near .. 1 far; see Camera.distances. A copy. Waits for the GPU."""
        with self._current() as gl:
            return download(gl, self._depth, (self.height, self.width), np.float32, 0x1902)

    def _current(self) -> OffScreen:
        if not self._framebuffer:
            raise BadInput("the picture is closed: make another with Context.picture")
        return self._gl

    def close(self) -> None:
        """Releases its memory."""
        names = (ctypes.c_uint * 2)(self.__dict__.get("_colour", 0), self.__dict__.get("_depth", 0))
        framebuffer = ctypes.c_uint(self.__dict__.get("_framebuffer", 0))
        self._colour = self._depth = self._framebuffer = 0
        gl = self._gl

        def delete() -> None:
            gl.call("glDeleteFramebuffers", "ip", 1, ctypes.addressof(framebuffer))
            gl.call("glDeleteTextures", "ip", 2, ctypes.addressof(names))

        if any(names) and not gl.inherited():
            gl.later(delete)

    def __enter__(self) -> Picture:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __del__(self) -> None:
        self.close()


def _texture(gl: OffScreen, form: int, width: int, height: int) -> int:
    name = ctypes.c_uint()
    gl.call("glCreateTextures", "iip", 0x0DE1, 1, ctypes.addressof(name))
    gl.call("glTextureStorage2D", "iiiii", name.value, 1, form, width, height)
    return name.value


def _upload(gl: OffScreen, texture: int, image: Array, form: int) -> None:
    rows = np.ascontiguousarray(image[::-1])  # OpenGL's row 0 is at the bottom
    kind = 0x1401 if rows.dtype == np.uint8 else 0x1406
    gl.call("glTextureSubImage2D", "iiiiiiiip", texture, 0, 0, 0, image.shape[1], image.shape[0], form, kind, rows.ctypes.data)


def download(gl: OffScreen, texture: int, shape: tuple[int, ...], kind: Any, form: int) -> Array:
    """A texture as an array, row 0 at the top."""
    rows = np.empty(shape, kind)
    gl.call("glGetTextureImage", "iiiizp", texture, 0, form, 0x1401 if kind == np.uint8 else 0x1406, rows.nbytes, rows.ctypes.data)
    return np.ascontiguousarray(rows[::-1])


def columns(matrix: ArrayLike, what: str) -> Array:
    """A (4, 4) matrix in C's order: column by column."""
    return np.ascontiguousarray(array_of(matrix, (4, 4), what).T)


class Drawn(Handle):
    """What draws: worlds and snapshots."""

    _kind = ""

    def draw(self, camera: Camera | View, picture: Picture | Target, light: Light | None = None, lights: Sequence[Light] = (),
             shadow: Shadow | None = None, fog: Fog | None = None, units_per_metre: float = 1.0) -> None:
        """Draws the water over what `picture` holds: nearer objects hide it, farther ones are seen through it. Colour and depth change only
        where there is water. light: the first light, None: white from (0.4, 0.8, 0.45); lights: up to 7 others; shadow: of the first light;
        units_per_metre: of the world that a View's matrix transforms. BadInput: the context has no OpenGL."""
        if not isinstance(camera, (Camera, View)) or not isinstance(picture, (Picture, Target)):
            raise BadInput(f"a world is drawn with a Camera or View into a Picture or Target, not with {camera!r} into {picture!r}")
        for value, kind, what in ((light, Light, "light"), (shadow, Shadow, "shadow"), (fog, Fog, "fog")):
            if value is not None:
                of_kind(value, kind, what)
        lights = each_of(lights, Light, "lights")
        size = picture.width, picture.height
        view = camera.view(size[0] / size[1]) if isinstance(camera, Camera) else camera
        if isinstance(picture, Picture):
            target = struct(c.Target, framebuffer=picture._framebuffer, width=size[0], height=size[1], colours=1 if picture.linear else 2)
            picture._current()
            if self._owned is not None and picture._gl is not self._owned.gl:
                raise BadInput("the picture is of another context: make it with picture() of this one's")
        else:
            target = struct(c.Target, framebuffer=picture.framebuffer, x=picture.x, y=picture.y, width=size[0], height=size[1],
                            colours=_named(picture.colours, _COLOURS, "colours"))
        rows = np.array([(each.direction, each.colour) for each in lights], c.LIGHT)
        matrices = columns(view.view, "view"), columns(view.projection, "projection")
        lighting = struct(c.Lighting, lights=rows.ctypes.data if len(rows) else None, lights_count=len(rows))
        if fog is not None:
            lighting.fog = ctypes.pointer(struct(c.Fog, kind=_named(fog.kind, _FOGS, "fog.kind"), colour=vector(fog.colour, 3, "fog.colour"),
                                                 density=fog.density, start=fog.start, end=fog.end, along_view=int(fog.along_view),
                                                 display=int(fog.display)))
        first = light or Light((0, 0, 0), (0, 0, 0))
        given = struct(c.View, view=address_of(matrices[0]), projection=address_of(matrices[1]), near_plane=view.near, far_plane=view.far,
                       light_direction=vector(first.direction, 3, "light.direction"), light_colour=vector(first.colour, 3, "light.colour"),
                       units_per_metre=units_per_metre, lighting=ctypes.pointer(lighting))
        if shadow is None:
            self._call(self._kind + "_draw", given, target)
            return
        projection = columns(shadow.projection, "shadow.projection")
        shaded = struct(c.Shadow, projection=address_of(projection), zero_to_one=int(shadow.zero_to_one), reversed=int(shadow.reversed),
                        bias=shadow.bias)
        lighting.shadow = ctypes.pointer(shaded)
        if isinstance(shadow.depths, int):
            shaded.texture = shadow.depths
            self._call(self._kind + "_draw", given, target)
            return
        depths = array_of(shadow.depths, (-1, -1), "shadow.depths")
        with off_screen_of(self) as gl:
            name = ctypes.c_uint(_texture(gl, 0x8CAC, depths.shape[1], depths.shape[0]))
            try:
                _upload(gl, name.value, depths, 0x1902)
                lighting.shadow.contents.texture = name.value
                self._call(self._kind + "_draw", given, target)
            finally:
                gl.call("glDeleteTextures", "ip", 1, ctypes.addressof(name))

    def picture(self, camera: Camera | View, width: int = 480, height: int = 360, background: ArrayLike | None = None,
                depth: ArrayLike = 1.0, linear: bool = False, **light: Any) -> Array:
        """Its picture, (height, width, 4), row 0 at the top, uint8, sRGB; linear: float32, linear radiance. background and depth as of
        Picture.fill; light: as of draw. BadInput: the context is not of off_screen."""
        with Picture(off_screen_of(self), width, height, linear) as picture:
            picture.fill(background, depth)
            self.draw(camera, picture, **light)
            return picture.colour()

    def buffers(self) -> dict[str, Any]:
        """The particles as OpenGL buffers, for a caller that draws them in the context's OpenGL context: names of position, velocity, id,
        wet_cells, wetness and attributes; count (rows); radius (m). Valid until the next step; layout as rivulet_buffers of rivulet.h."""
        buffers = struct(c.Buffers)
        self._call(self._kind + "_buffers", buffers)
        values = {name: getattr(buffers, name) for name, *_ in c.Buffers._fields_[1:]}
        return {**values, "attributes": list(buffers.attributes)}


def off_screen_of(handle: Handle) -> OffScreen:
    owned = handle._owned
    if owned is None or owned.gl is None:
        raise BadInput("there is no OpenGL off screen for a picture: make the Context with off_screen=True, and do not close it before")
    return owned.gl


def _named(name: str, names: dict[str, int], what: str) -> int:
    if name not in names:
        raise BadInput(f"{what} is '{name}': use {', '.join(names)}")
    return names[name]
