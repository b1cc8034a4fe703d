"""drawing.py FOLDER: pictures as arrays: where the water is, what hides it, light and conventions; skins' maps; other threads. Exit 77: no OpenGL."""
import multiprocessing
import os
import subprocess
import sys
import threading

import numpy as np
import rivulet
from rivulet._off_screen import OffScreen

from refusals import refused

POOL = {"fluid": {"spacing": 0.04, "box": {"max": [1, 0.6, 1]}, "blocks": [{"max": [1, 0.32, 1]}]}}
EYE, AT = (0.5, 1.6, 2.4), (0.5, 0.2, 0.5)
SIZE = WIDTH, HEIGHT = 240, 160


try:
    context = rivulet.Context(backend="cpu", off_screen=True)
except rivulet.Error as error:
    print(f"skipped: {error}")
    sys.exit(77)
camera = rivulet.Camera(EYE, AT, 35)


def pixel(place):
    """(column, row) of a place (m), by the camera's own matrices."""
    view = camera.view(WIDTH / HEIGHT)
    x, y, _, w = view.projection @ view.view @ np.array([*place, 1])
    return int((x / w + 1) / 2 * WIDTH), int((1 - y / w) / 2 * HEIGHT)


with context, context.world(POOL) as world:
    for _ in range(40):
        world.step(1 / 60)
    grey = (0.5, 0.5, 0.5)
    with context.picture(*SIZE) as picture:
        picture.fill(grey)
        assert (picture.colour() == [128, 128, 128, 255]).all() and (picture.depth() == 1).all()
        world.draw(camera, picture)
        colour, depth = picture.colour(), picture.depth()
    assert colour.shape == (HEIGHT, WIDTH, 4) and colour.dtype == np.uint8 and colour.flags.c_contiguous and depth.dtype == np.float32
    assert (colour == world.picture(camera, *SIZE, background=grey)).all(), "the same picture in one call"
    # Water is where the pool is, row 0 is at the top, and its depth is that of the surface where a ray meets it.
    wet = depth < 1
    assert (colour[~wet] == [128, 128, 128, 255]).all() and 0.15 < wet.mean() < 0.6, wet.mean()
    column, row = pixel((0.5, 0.32, 0.5))
    assert wet[row, column] and not wet[:15].any() and not wet[:, 0].any()
    for place in ((0.3, 0.32, 0.4), (0.5, 0.32, 0.5), (0.8, 0.32, 0.7)):
        column, row = pixel(place)
        expected = -(camera.view(1.5).view @ [*place, 1])[2]
        assert abs(camera.distances(depth)[row, column] - expected) < 0.04, (camera.distances(depth)[row, column], expected)
    assert np.allclose(camera.depths(camera.distances(depth)), depth, atol=1e-6)
    # With all defaults water differs from what is behind it: by more than 30 of 255 on its surface, more than 8 on its side.
    with context.picture(*SIZE) as picture:
        behind = picture.colour()[..., :3].astype(int)
        contrast = np.abs(world.picture(camera, *SIZE)[..., :3].astype(int) - behind).max(axis=2)
    for place, least in (((0.3, 0.32, 0.4), 30), ((0.7, 0.32, 0.8), 30), ((0.3, 0.15, 1), 8), ((0.7, 0.15, 1), 8)):
        column, row = pixel(place)
        assert np.median(contrast[row - 3:row + 4, column - 3:column + 4]) > least, (place, contrast[row - 3:row + 4, column - 3:column + 4])
    # A linear picture has the same background.
    with context.picture(*SIZE, linear=True) as picture:
        bright = picture.colour()[..., :3]
    assert np.abs(255 * (1.055 * bright ** (1 / 2.4) - 0.055) - behind).max() < 1
    # A background that is nearer hides the water, in the left half here; an image is seen where there is no water.
    image, near = np.zeros((HEIGHT, WIDTH, 3)), np.ones((HEIGHT, WIDTH))
    image[:20], near[:, :WIDTH // 2] = (1, 0, 0), camera.depths(0.5)
    over = world.picture(camera, *SIZE, background=image, depth=near)
    assert (over[:20, :, :3] == [255, 0, 0]).all()
    assert (over[20:, :WIDTH // 2] == [0, 0, 0, 255]).all() and (over[:, WIDTH // 2:, :3][wet[:, WIDTH // 2:]] != [0, 0, 0]).any()
    # Matrices of one's own: a mirrored projection mirrors the picture.
    view = camera.view(WIDTH / HEIGHT)
    mirrored = world.picture(rivulet.View(view.view, np.diag([-1, 1, 1, 1]) @ view.projection, camera.near, camera.far), *SIZE, background=grey)
    assert np.abs(mirrored[:, ::-1].astype(int) - colour).mean() < 0.05  # a shift by one pixel is 0.07
    # Linear radiance: encoded, it is the picture in bytes.
    linear = world.picture(camera, *SIZE, background=np.array([0.2140] * 3), linear=True)
    encoded = np.where(linear < 0.0031308, 12.92 * linear, 1.055 * np.clip(linear, 0, 1) ** (1 / 2.4) - 0.055)
    assert linear.dtype == np.float32 and np.abs(255 * encoded[..., :3] - colour[..., :3])[~wet].max() < 1
    assert np.abs(255 * encoded[..., :3] - colour[..., :3]).max() <= 1  # a byte is rounded or cut
    # Fog that is dense hides the water's own colours; a light of one colour tints its highlights; a shadow map of zeros takes light away.
    fogged = world.picture(camera, *SIZE, background=(0, 0, 1), fog=rivulet.Fog("exponential", (0, 0, 1), density=20))
    assert np.abs(fogged[wet].astype(int) - [0, 0, 255, 255]).max() <= 1  # exp(-20 / m * 1 m) is 2e-9
    red = world.picture(camera, *SIZE, background=grey, light=rivulet.Light((0, 1, 0), (20, 0, 0)))
    lit = world.picture(camera, *SIZE, background=grey, light=rivulet.Light((0, 1, 0), (20, 20, 20)))
    assert (lit[wet].astype(int) - red[wet])[:, 1:3].sum() > 0 and (red[..., 0] == lit[..., 0]).mean() > 0.9
    above = rivulet.Camera((0.5, 3, 0.5), (0.5, 0, 0.5), up=(0, 0, -1)).view(1)
    map = rivulet.Shadow(np.zeros((16, 16)), above.projection @ above.view)
    dark = world.picture(camera, *SIZE, background=grey, light=rivulet.Light((0, 1, 0), (20, 20, 20)), shadow=map)
    open_map = rivulet.Shadow(np.ones((16, 16)), above.projection @ above.view)
    assert dark[wet].astype(int).sum() < lit[wet].astype(int).sum()
    assert (world.picture(camera, *SIZE, background=grey, light=rivulet.Light((0, 1, 0), (20, 20, 20)), shadow=open_map) == lit).all()
    # What surrounds the water is reflected: a green sky makes it greener.
    context.set_surroundings(np.broadcast_to(np.array([0, 1, 0], np.float32), (8, 16, 3)))
    green = world.picture(camera, *SIZE, background=grey)
    assert (green[wet][:, 1].astype(int) - colour[wet][:, 1]).mean() > (green[wet][:, 0].astype(int) - colour[wet][:, 0]).mean() + 3

    # A snapshot is the water as it was, also while another thread steps the world.
    with context.snapshot() as snapshot:
        before = world.picture(camera, *SIZE)
        snapshot.take(world)
        thread = threading.Thread(target=lambda: [world.step(1 / 60, gravity=(5, -9.81, 0)) for _ in range(20)])
        thread.start()
        while True:
            assert (snapshot.picture(camera, *SIZE) == before).all()
            if not thread.is_alive():
                break
        thread.join()
        assert (world.picture(camera, *SIZE) != before).any()
        assert snapshot.buffers()["count"] == world.stats().particles
        # A recorded frame is the picture of its moment, though the world is elsewhere.
        path = os.path.join(sys.argv[1], "drawn.rrec")
        with world.record(path):
            world.step(1 / 60)
            then = world.picture(camera, *SIZE)
            for _ in range(10):
                world.step(1 / 60)
        later = np.abs(world.picture(camera, *SIZE).astype(int) - then).mean()
        snapshot.replay(world, path, 0)
        assert np.abs(snapshot.picture(camera, *SIZE).astype(int) - then).mean() < 0.1 * later, later
    # From a thread that made nothing.
    seen = []
    thread = threading.Thread(target=lambda: seen.append(world.picture(camera, *SIZE)))
    thread.start()
    thread.join()
    assert (seen[0] == world.picture(camera, *SIZE)).all()
    # Another context of the same thread, with backend gl; its pictures are its own.
    with rivulet.Context(backend="gl", off_screen=True) as other, other.world(POOL) as its:
        assert other.device.startswith("gl:")
        for _ in range(3):
            its.step(1 / 60)
        assert (its.picture(camera, *SIZE) != other.picture(*SIZE).colour()).any() and its.buffers()["position"] > 0
        refused(lambda: its.rows(), "particles", "GPU")
        refused(lambda: world.draw(camera, other.picture(*SIZE)), "another context")
    assert len(world.picture(camera, *SIZE))

    refused(lambda: rivulet.Camera((0, 1, 0), (0, 0, 0)).view(1), "looks at")
    refused(lambda: rivulet.Camera(EYE, AT, near=0).view(1), "near")
    refused(lambda: context.picture(0, 10), "width is 0")
    refused(lambda: world.picture(camera, *SIZE, background=np.zeros((3, 3, 3))), "background", "(160, 240)")
    refused(lambda: world.picture(camera, *SIZE, background="red"), "background is no array")
    refused(lambda: world.picture(camera, *SIZE, background=np.full((HEIGHT, WIDTH, 3), 128)), "from 128 to 128", "uint8")
    refused(lambda: world.picture(camera, *SIZE, background=(0.5, np.nan, 0.5)), "not finite")
    refused(lambda: world.picture(camera, *SIZE, depth=2), "outside 0 to 1")
    refused(lambda: world.picture("left", *SIZE), "a Camera or View")
    refused(lambda: world.picture(camera, 64.5, 48), "width is 64.5")
    assert world.picture(camera, 64.0, np.int64(48)).shape == (48, 64, 4)
    refused(lambda: world.picture(camera, *SIZE, fog=rivulet.Fog("thick", (0, 0, 0))), "fog.kind", "exponential")
    closed = context.picture(8, 8)
    closed.close()
    refused(closed.colour, "closed")

    # The map of a skin: a drop near the top of the uvs is near the top of the array, and as high as a drop of its volume can be.
    square = rivulet.Mesh([[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]], [[0, 1, 2], [0, 2, 3]], uvs=[[0, 0], [1, 0], [1, 1], [0, 1]])
    with context.skin(square, map_size=64) as skin:
        skin.add((0.03, 0.08, 0), 20)
        for _ in range(2):
            skin.step(1 / 60, gravity=(0, 0, -9.81))
        heights = skin.map()[..., 2]
        row, column = np.unravel_index(heights.argmax(), heights.shape)
        assert abs(row - 64 * 0.2) < 4 and abs(column - 64 * 0.3) < 4 and 0.5 < heights.max() < 3.5, (row, column, heights.max())
        assert skin.texture() > 0

# In an OpenGL context of the caller's own: the same picture in a framebuffer of its own, upside down as OpenGL has it.
host = OffScreen()
with host, rivulet.Context(backend="cpu", find=lambda name: host._egl.eglGetProcAddress(name.encode())) as context, context.world(POOL) as world:
    with rivulet.Context(backend="cpu", off_screen=True) as other, other.world(POOL) as same:
        expected = same.picture(camera, *SIZE)
    own = rivulet.Picture(host, *SIZE, linear=False)
    own.fill()
    world.draw(camera, rivulet.Target(own._framebuffer, *SIZE))
    assert (own.colour() == expected).all()
    refused(lambda: world.draw(camera, own), "another context")
    refused(lambda: world.picture(camera), "off_screen=True")
    refused(lambda: world.draw(camera, rivulet.Target(own._framebuffer, *SIZE, colours="bright")), "colours", "sRGB")
    own.close()
    context.lost()


# A world whose OpenGL context is current on another thread is not closed, and can be closed later.
context = rivulet.Context(backend="cpu", off_screen=True)
world, taken, free = context.world(POOL), threading.Event(), threading.Event()


def hold():
    with context._owned.gl:
        taken.set()
        free.wait()


thread = threading.Thread(target=hold)
thread.start()
taken.wait()
try:
    world.close()
    raise AssertionError("closed")
except rivulet.Error as error:
    assert "another thread" in str(error), error
free.set()
thread.join()
world.step(1 / 60)
# What is dropped while another thread has its OpenGL context is destroyed by the next call that has it.
with rivulet.Context(backend="cpu", off_screen=True) as own:
    kept, drop, done = own.world(POOL), threading.Event(), threading.Event()
    one = own.memory
    dropped = [own.world(POOL) for _ in range(3)]
    whole = own.memory

    def draws():
        with kept._open().gl:
            drop.set()
            done.wait()

    thread = threading.Thread(target=draws)
    thread.start()
    drop.wait()
    dropped.clear()
    assert own.memory == whole > one
    done.set()
    thread.join()
    assert own.memory == one, (own.memory, one)
    kept.close()
world.close()
context.close()

# Contexts of several threads at a time.
def alone(k):
    with rivulet.Context(backend=("cpu", "gl")[k % 2], off_screen=True) as context, context.world(POOL) as world:
        for _ in range(3):
            world.step(1 / 60)
            picture = world.picture(camera, 64, 48)
        seen.append((k % 2, picture.tobytes()))


seen = []
threads = [threading.Thread(target=alone, args=(k,)) for k in range(4)]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join()
assert len(seen) == 4 and len(set(seen)) <= 2, "contexts of other threads changed a picture"


# A process that was forked is told at once that it cannot draw, and at its end leaves alone what its parent made.
def drawn(_):
    try:
        with rivulet.Context(backend="cpu", off_screen=True) as own, own.world(POOL) as its:
            return its.picture(camera, 64, 48).shape
    except rivulet.Error as error:
        return str(error)


with rivulet.Context(backend="cpu", off_screen=True) as context, context.world(POOL) as world, context.picture(64, 48) as picture:
    for wrong in ("light", "fog", "shadow"):
        refused(lambda wrong=wrong: world.draw(camera, picture, **{wrong: 3}), f"{wrong} is 3")
    refused(lambda: world.draw(camera, picture, lights=5), "lights is 5")
    world.draw(camera, picture)
    before = world.picture(camera, 64, 48)
    with multiprocessing.get_context("fork").Pool(2) as pool:
        said = pool.map_async(drawn, range(2)).get(60)
    assert all('get_context("spawn")' in each for each in said), said
    child = os.fork()
    if child == 0:
        for work in (lambda: world.picture(camera, 64, 48), picture.colour):
            try:
                work()
                os._exit(3)
            except rivulet.Error as error:
                if "spawn" not in str(error):
                    os._exit(4)
        world.step(1 / 60)
        picture.close()
        world.close()
        sys.exit(0)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 0, status
    assert (world.picture(camera, 64, 48) == before).all()
# Without a driver there is a sentence.
program = "import rivulet\ntry:\n    rivulet.Context(off_screen=True)\nexcept rivulet.Error as error:\n    print(error)"
said = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, env={**os.environ, "__EGL_VENDOR_LIBRARY_FILENAMES": "/none.json"})
assert "no OpenGL 4.5" in said.stdout and "install" in said.stdout, said
print("all holds")
