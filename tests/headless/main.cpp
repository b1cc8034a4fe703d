// A program that links rivulet_session alone: it opens a scene and steps it, with no window library. run.sh checks what it needs.
#include <cmath>
#include <cstdio>

#include "fluid/render/backend.h"
#include "fluid/session/session.h"

int main(int argc, char** argv) {
    using namespace rivulet;
    if (argc != 2) return 2;
    Result<SceneFile> scene = loadScene(argv[1], {});
    if (!scene) {
        std::fprintf(stderr, "%s\n", scene.error().message.c_str());
        return 2;
    }
    const std::unique_ptr<Device> device = makeCpu();
    Result<std::unique_ptr<Session>> session = Session::create(*scene, *device, {});
    if (!session) {
        std::fprintf(stderr, "%s\n", session.error().message.c_str());
        return 1;
    }
    for (int frame = 0; frame < 3; ++frame) (*session)->step(frameSeconds(*scene), true);
    const FluidWorld& world = (*session)->world();
    std::printf("%u particles, %.4f s\n", world.particles().count, world.time());
    return world.particles().count > 0 && std::abs(world.time() - 3 * frameSeconds(*scene)) < 1e-6 ? 0 : 1;
}
