"""Pictures and films of a plan, rendered by MuJoCo without a screen (EGL)."""

import os
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from jaxsusp._files import atomic_path
from jaxsusp._types import Float
from jaxsusp.errors import InputError
from jaxsusp.planning.plan import Plan
from jaxsusp.report.drawing.solids import Camera
from jaxsusp.report.drawing.style import picture_file
from jaxsusp.report.plan.scene import Stills, plan_view
from jaxsusp.verify.engine import mujoco
from jaxsusp.verify.simulation import Simulation, simulate

WIDTH, HEIGHT = 1280, 720
FRAMES = 15  # a second
SPEED = 4.0
"""How much faster than life a film runs."""


FIELD = 45.0
"""Degrees; MuJoCo's vertical field of view."""

BORDER = 0.08
"""Share of the picture that stays empty around the system."""


class NoRendererError(InputError):
    """This machine cannot render without a screen."""


class Renderer:
    """Renders states of one model; closes its OpenGL context at the end of the block."""

    def __init__(self, model: Any, plan: Plan):
        self._context = _open(WIDTH, HEIGHT)
        try:
            self._scene = mujoco.MjvScene(model, 2000)
            self._option = mujoco.MjvOption()
            self._camera = _camera(plan)
            self._scene.flags[mujoco.mjtRndFlag.mjRND_SHADOW.value] = 0  # slow in software
            self._target = mujoco.MjrContext(model, mujoco.mjtFontScale.mjFONTSCALE_150.value)
            mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN.value, self._target)
        except Exception as error:
            self._context.free()
            raise _no_renderer(error) from error
        self._view = mujoco.MjrRect(0, 0, WIDTH, HEIGHT)

    def __enter__(self) -> "Renderer":
        return self

    def __exit__(self, *_) -> None:
        self._target.free()
        self._context.free()

    def image(self, model: Any, data: Any) -> np.ndarray:
        """The state as an image (HEIGHT, WIDTH, 3), uint8."""
        mujoco.mjv_updateScene(
            model, data, self._option, None, self._camera,
            mujoco.mjtCatBit.mjCAT_ALL.value, self._scene,
        )  # fmt: skip
        mujoco.mjr_render(self._view, self._scene, self._target)
        image = np.empty((HEIGHT, WIDTH, 3), np.uint8)
        mujoco.mjr_readPixels(image, None, self._view, self._target)
        return np.ascontiguousarray(image[::-1])


def _open(width: int, height: int) -> Any:
    """An OpenGL context without a window."""
    try:
        from mujoco.egl import GLContext

        context = GLContext(width, height)
        context.make_current()
        return context
    except Exception as error:  # every missing piece fails in its own way
        raise _no_renderer(error) from error


def _no_renderer(error: Exception) -> NoRendererError:
    reason = (str(error).splitlines() or [type(error).__name__])[0]
    return NoRendererError(
        f"pictures cannot be rendered here: no EGL renderer ({reason}); install Mesa's EGL "
        "(libegl1, libegl-mesa0) or leave out --images and --video"
    )


def _camera(plan: Plan) -> Any:
    """A view of the whole system, wherever it goes, from where the path is seen best."""
    stills = Stills.of(plan)
    points = np.concatenate([plan.position, stills.chains.reshape(-1, 3)])
    view, middle = plan_view(plan, stills), (points.min(axis=0) + points.max(axis=0)) / 2
    camera = mujoco.MjvCamera()
    units = plan.scenario.units  # the model is in the task's own units
    camera.lookat[:] = units.inside(middle)
    camera.distance = _distance(points - middle, view) / units.length
    camera.azimuth = float(np.rad2deg(view.azimuth)) + 180  # MuJoCo's is where it looks to
    camera.elevation = -float(np.rad2deg(view.elevation))
    return camera


def _distance(points: Float[np.ndarray, "points xyz"], view: Camera) -> float:
    """How far from the middle the camera has to be for all points to be in its picture (m)."""
    upright = np.tan(np.deg2rad(FIELD) / 2) * (1 - BORDER)
    half = upright * np.array([WIDTH / HEIGHT, 1.0])
    return float((np.abs(view.project(points)) / half + (points @ view.towards)[:, None]).max())


def render(
    plan: Plan,
    images: str | os.PathLike[str] | None = None,
    video: str | os.PathLike[str] | None = None,
    count: int = 5,
) -> tuple[Simulation, list[Path]]:
    """Simulate a plan and keep pictures of it.

    Args:
        plan: any plan.
        images: folder for `count` PNG files, evenly spaced in time.
        video: an MP4 file.
        count: number of images.

    Returns:
        The simulation, and the files written.

    Raises:
        NoRendererError: the machine has no headless renderer.
        InputError: the video cannot be encoded.
    """
    duration = plan.law.duration
    wanted = list(np.linspace(0, duration, count)) if images is not None else []
    frames: list[np.ndarray] = []
    stills: list[np.ndarray] = []
    renderer: Renderer | None = None
    pace = SPEED / FRAMES

    def seen(model: Any, data: Any, time: float) -> None:
        nonlocal renderer
        if renderer is None:
            renderer = Renderer(model, plan)
        still = len(stills) < len(wanted) and time >= wanted[len(stills)] - 1e-6
        moving = video is not None and time >= len(frames) * pace - 1e-6
        if not (still or moving):
            return
        image = renderer.image(model, data)
        if still:
            stills.append(image)
        if moving:
            frames.append(image)

    try:
        simulation = simulate(plan.rigging, seen)
    finally:
        if renderer is not None:
            renderer.__exit__()
    files = []
    if images is not None:
        folder = Path(images)
        folder.mkdir(parents=True, exist_ok=True)
        for time, image in zip(wanted, stills, strict=False):
            file = folder / f"{time:06.2f}s.png"
            picture_file(image, file)
            files.append(file)
    if video is not None:
        _encode(frames, Path(video))
        files.append(Path(video))
    return simulation, files


def _encode(frames: list[Float[np.ndarray, "h w rgb"]], path: Path) -> None:
    """Write frames as H.264 in MP4."""
    import imageio_ffmpeg

    try:
        with atomic_path(path) as scratch, warnings.catch_warnings():
            # JAX warns of forks; this child becomes ffmpeg at once and never touches JAX.
            warnings.filterwarnings("ignore", "os.fork", RuntimeWarning)
            writer = imageio_ffmpeg.write_frames(
                scratch, (WIDTH, HEIGHT), fps=FRAMES, codec="libx264", macro_block_size=8,
                output_params=["-f", "mp4"],
            )  # fmt: skip
            writer.send(None)
            for frame in frames:
                writer.send(frame)
            writer.close()
    except (OSError, RuntimeError) as error:
        raise InputError(
            f"video = {path}: cannot be written ({error}); give a file name that ends in .mp4 in "
            "a folder that exists"
        ) from error
