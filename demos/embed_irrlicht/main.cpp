// Water in Irrlicht, an engine with left-handed coordinates: +z points into the picture.
// embed_irrlicht [--frames N] [--picture FILE.ppm] [--dry]: stops after N frames and writes the last one; --dry draws no water.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <rivulet/rivulet.h>

#include "terrace.h"

extern "C" void (*glXGetProcAddressARB(const unsigned char*))(void);

namespace {

using namespace irr;

struct Water {
    rivulet_error why{};
    rivulet_context* context = nullptr;
    rivulet_world* world = nullptr;

    bool create() {
        rivulet_context_options options{};
        options.size = sizeof options;
        options.find = [](const char* name) -> rivulet_function {
            return glXGetProcAddressARB(reinterpret_cast<const unsigned char*>(name));
        };
        if (rivulet_context_create(&options, &context, &why) != RIVULET_OK) return false;
        rivulet_world_options scene{};
        scene.size = sizeof scene;
        scene.json = R"({"fluid": {"spacing": 0.025, "box": {"max": [1.2, 1.2, 1.2]}, "blocks": [{"max": [1.2, 0.3, 1.2]},
            {"shape": "ball", "min": [0.25, 0.5, 0.45], "max": [0.55, 0.8, 0.75]}]}})";
        return rivulet_world_create(context, &scene, &world, &why) == RIVULET_OK;
    }
    // Into Irrlicht's window, after its opaque objects.
    bool stepAndDraw(const scene::ICameraSceneNode& camera, core::dimension2du size) {
        if (rivulet_world_step(world, nullptr, 1.0 / 60, &why) != RIVULET_OK) return false;
        core::matrix4 mirror;
        mirror.setScale({1, 1, -1});
        core::matrix4 eye = camera.getViewMatrix();
        eye *= mirror;
        rivulet_view view{};
        view.size = sizeof view;
        view.view = eye.pointer();
        view.projection = camera.getProjectionMatrix().pointer();
        view.near_plane = 0.5F * camera.getNearValue();  // Irrlicht's depth begins at 0, where that of OpenGL begins at -1
        view.far_plane = camera.getFarValue();
        rivulet_target target{};
        target.size = sizeof target;
        target.width = static_cast<int32_t>(size.Width);
        target.height = static_cast<int32_t>(size.Height);
        return rivulet_world_draw(world, &view, &target, &why) == RIVULET_OK;
    }
    void destroy() {
        rivulet_world_destroy(world);
        rivulet_context_destroy(context);
    }
};

// What is in the window, its upper row first.
void write(const char* path, core::dimension2du size) {
    FILE* file = std::fopen(path, "wb");
    if (file == nullptr) return;
    std::fprintf(file, "P6 %u %u 255\n", size.Width, size.Height);
    std::vector<unsigned char> row(size_t{3} * size.Width);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    for (u32 y = size.Height; y-- > 0;) {
        glReadPixels(0, static_cast<GLint>(y), static_cast<GLsizei>(size.Width), 1, GL_RGB, GL_UNSIGNED_BYTE, row.data());
        std::fwrite(row.data(), 1, row.size(), file);
    }
    std::fclose(file);
}

}  // namespace

int main(int count, char** arguments) {
    long frames = -1;
    const char* picture = nullptr;
    bool dry = false;
    for (int k = 1; k < count; ++k) {
        dry = dry || std::strcmp(arguments[k], "--dry") == 0;
        if (std::strcmp(arguments[k], "--frames") == 0 && k + 1 < count) frames = std::strtol(arguments[++k], nullptr, 10);
        if (std::strcmp(arguments[k], "--picture") == 0 && k + 1 < count) picture = arguments[++k];
    }
    SIrrlichtCreationParameters options;
    options.DriverType = video::EDT_OPENGL;
    options.WindowSize = {640, 480};
    options.AntiAlias = 4;
    options.LoggingLevel = ELL_ERROR;
    IrrlichtDevice* device = createDeviceEx(options);
    if (device == nullptr) return 1;
    device->setWindowCaption(L"Water in Irrlicht");
    video::IVideoDriver& driver = *device->getVideoDriver();
    scene::ISceneManager& scene = *device->getSceneManager();
    const std::string shade = std::strchr(std::strstr(kFragment, "out vec4 colour;"), '\n');
    const s32 material = driver.getGPUProgrammingServices()->addHighLevelShaderMaterial(
        "#version 450 compatibility\nout vec3 normal; out vec2 tile; flat out vec3 one, other;\n"
        "void main() { normal = gl_Normal; tile = gl_MultiTexCoord0.xy; one = gl_MultiTexCoord1.xyz; other = gl_MultiTexCoord2.xyz;\n"
        "    gl_Position = gl_ModelViewProjectionMatrix * gl_Vertex; }",
        "main", video::EVST_VS_2_0,
        ("#version 450 compatibility\nin vec3 normal; in vec2 tile; flat in vec3 one, other; out vec4 colour;" + shade).c_str(), "main");
    scene::SMesh mesh;
    scene::SMeshBufferTangents* parts = terrace();
    mesh.addMeshBuffer(parts);
    parts->drop();
    mesh.recalculateBoundingBox();
    scene::IMeshSceneNode& node = *scene.addMeshSceneNode(&mesh);
    node.getMaterial(0).MaterialType = static_cast<video::E_MATERIAL_TYPE>(material);
    node.getMaterial(0).BackfaceCulling = false;
    scene::ICameraSceneNode& camera = *scene.addCameraSceneNode(nullptr, {0.6F, 1.05F, -2.75F}, {0.6F, 0.154F, -0.6F});
    camera.setFOV(42.08F * core::DEGTORAD);
    camera.setNearValue(0.1F);
    camera.setFarValue(15);
    Water water;
    bool works = material >= 0 && (dry || water.create());
    for (long frame = 0; frame != frames && works && device->run(); ++frame) {
        driver.beginScene(true, true, {255, 168, 201, 230});
        scene.drawAll();
        works = dry || water.stepAndDraw(camera, driver.getScreenSize());
        if (works && frame + 1 == frames && picture != nullptr) write(picture, driver.getScreenSize());
        driver.endScene();
    }
    if (!works) std::fprintf(stderr, "embed_irrlicht: %s\n", water.why.message);
    water.destroy();
    device->drop();
    return works ? 0 : 1;
}
