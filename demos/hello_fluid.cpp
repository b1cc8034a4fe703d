// The smallest host in C++: a GLFW window, a scene in OpenGL 4.5 core, and water in it.
// hello_fluid [--frames N] [--picture FILE.ppm] [--dry]: stops after N frames and writes the last one; --dry draws no water.
#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include <cstdio>
#include <cstring>
#include <fstream>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>

#include "hello_scene.h"
#include "rivulet/engine/gpu/host_state.h"
#include "rivulet/engine/gpu/load.h"
#include "rivulet/fluid/render/backend.h"
#include "rivulet/fluid/render/fluid_upload.h"
#include "rivulet/fluid/render/water_renderer.h"

using namespace rivulet;
namespace {

constexpr int kWidth = 640, kHeight = 480;
Status run(GLFWwindow* window, int frames, const char* picture, bool dry) {
    if (Status loaded = gpu::load(glfwGetProcAddress); !loaded) return loaded;
    const GLuint program = sceneProgram();
    GLuint corners = 0;
    glCreateVertexArrays(1, &corners);

    const std::unique_ptr<Device> device = makeDevice("auto", currentGlFacts(), stderrLog());
    FluidParams params;
    params.spacing = 0.025F;
    params.box.max = vec3(1.2F);
    params.ellipsoids = true;  // a smoother surface
    params.blocks = {{.max = {1.2F, 0.3F, 1.2F}}, {.min = {0.25F, 0.5F, 0.45F}, .max = {0.55F, 0.8F, 0.75F}, .shape = "ball"}};
    auto world = FluidWorld::create(*device, params, {}, stderrLog());
    if (!world) return world.error();
    auto water = WaterRenderer::create({.sky = {.horizon = {0.55F, 0.66F, 0.76F}, .zenith = {0.20F, 0.34F, 0.56F}, .clouds = 0.3F}});
    if (!water) return water.error();
    FluidUpload upload;
    FrameView view{.cameraPosWorld = {0.6F, 1.05F, 2.75F}, .nearPlane = 0.1F, .farPlane = 15, .width = kWidth, .height = kHeight};
    view.view = glm::lookAt(view.cameraPosWorld, vec3(0.6F, 0.154F, 0.6F), vec3(0, 1, 0));
    view.projection = glm::perspective(glm::radians(42.08F), float(kWidth) / kHeight, view.nearPlane, view.farPlane);
    view.lightDirWorld = glm::normalize(view.lightDirWorld);
    view.lightColour = vec3(1.0F);

    glEnable(GL_DEPTH_TEST);  // set once, as is all state below: drawing water restores it
    glUseProgram(program);
    glBindVertexArray(corners);
    glClearColor(0.66F, 0.79F, 0.90F, 1);
    for (int frame = 0; frame != frames && !glfwWindowShouldClose(window); ++frame) {
        glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
        drawScene(program, view.projection * view.view);
        {
            const gpu::HostState keep;  // saves the host's state: stepping and uploading may use OpenGL
            (*world)->step({}, 1.0 / 60);
            if (Status stepped = (*world)->lastStep(); !stepped) return stepped;
            auto fluid = upload.view(**world, {});
            if (!fluid) return fluid.error();
            if (Status drawn = dry ? ok() : (*water)->draw(keep, view, *fluid, {}, {.width = kWidth, .height = kHeight}); !drawn)
                return drawn;
        }
        if (frame + 1 == frames && picture != nullptr) {
            std::vector<char> pixels(3 * kWidth * kHeight);
            glReadPixels(0, 0, kWidth, kHeight, GL_RGB, GL_UNSIGNED_BYTE, pixels.data());
            std::ofstream file(picture, std::ios::binary);
            file << "P6 " << kWidth << " " << kHeight << " 255\n";
            for (int row = kHeight - 1; row >= 0; --row) file.write(&pixels[size_t(3) * kWidth * row], 3 * kWidth);
            if (!file) return failed(std::string("cannot write ") + picture);
        }
        glfwSwapBuffers(window);
        glfwPollEvents();
        if (glGetError() != GL_NO_ERROR) return failed("glGetError reports an error");
    }
    return ok();
}

}  // namespace

int main(int count, char** arguments) {
    int frames = -1;
    const char* picture = nullptr;
    bool dry = false;
    for (int k = 1; k < count; ++k) {
        dry = dry || std::strcmp(arguments[k], "--dry") == 0;
        if (std::strcmp(arguments[k - 1], "--frames") == 0) frames = std::atoi(arguments[k]);
        if (std::strcmp(arguments[k - 1], "--picture") == 0) picture = arguments[k];
    }
    if (glfwInit() == 0) return 1;
    glfwWindowHint(GLFW_CONTEXT_VERSION_MAJOR, 4);
    glfwWindowHint(GLFW_CONTEXT_VERSION_MINOR, 5);
    glfwWindowHint(GLFW_OPENGL_PROFILE, GLFW_OPENGL_CORE_PROFILE);
    glfwWindowHint(GLFW_SAMPLES, 4);
    GLFWwindow* window = glfwCreateWindow(kWidth, kHeight, "Hello, fluid", nullptr, nullptr);
    if (window == nullptr) return 1;
    glfwMakeContextCurrent(window);
    const Status ran = run(window, frames, picture, dry);
    if (!ran) std::fprintf(stderr, "hello_fluid: %s\n", ran.error().message.c_str());
    glfwTerminate();
    return ran ? 0 : 1;
}
