// Water in OGRE: in its window, in a render texture, which OGRE draws upside down, and in a compositor.
// embed_ogre [--frames N] [--picture FILE.ppm] [--dry]: stops after N frames and writes the window's picture, those of the texture and of
// the compositor as FILE.ppm.texture and FILE.ppm.compositor, and the window's without water as FILE.ppm.after; --dry draws no water.
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include <rivulet/rivulet.h>
#include "terrace.h"

extern "C" void (*glXGetProcAddressARB(const unsigned char*))(void);

namespace {

constexpr int kWidth = 640, kHeight = 480;

rivulet_function find(const char* name) { return glXGetProcAddressARB(reinterpret_cast<const unsigned char*>(name)); }

// Draws the water after the objects of each render target that it listens to.
class Water : public Ogre::RenderTargetListener {
  public:
    rivulet_error why{};
    bool works = false, shown = true;

    bool create() {
        rivulet_context_options options{};
        options.size = sizeof options;
        options.find = find;
        if (rivulet_context_create(&options, &context_, &why) != RIVULET_OK) return false;
        rivulet_world_options scene{};
        scene.size = sizeof scene;
        scene.json = R"({"fluid": {"spacing": 0.025, "box": {"max": [1.2, 1.2, 1.2]}, "blocks": [{"max": [1.2, 0.3, 1.2]},
            {"shape": "ball", "min": [0.25, 0.5, 0.45], "max": [0.55, 0.8, 0.75]}]}})";
        return works = rivulet_world_create(context_, &scene, &world_, &why) == RIVULET_OK;
    }
    void step() { works = works && rivulet_world_step(world_, nullptr, 1.0 / 60, &why) == RIVULET_OK; }
    void postViewportUpdate(const Ogre::RenderTargetViewportEvent& event) override {
        if (!works || !shown) return;
        const Ogre::Viewport& box = *event.source;
        const Ogre::Camera& camera = *box.getCamera();
        // OGRE's matrices have rows; it negates the second row of a projection into a texture.
        Ogre::Matrix4 projection = camera.getProjectionMatrixWithRSDepth();
        if (box.getTarget()->requiresTextureFlipping())
            for (int k = 0; k < 4; ++k) projection[1][k] = -projection[1][k];
        projection = projection.transpose();
        const Ogre::Matrix4 view = Ogre::Matrix4(camera.getViewMatrix(true)).transpose();
        rivulet_view seen{};
        seen.size = sizeof seen;
        seen.view = view[0];
        seen.projection = projection[0];
        seen.near_plane = camera.getNearClipDistance();
        seen.far_plane = camera.getFarClipDistance();
        int framebuffer = 0;
        reinterpret_cast<void (*)(unsigned, int*)>(find("glGetIntegerv"))(0x8CA6, &framebuffer);  // GL_DRAW_FRAMEBUFFER_BINDING
        const rivulet_target target{sizeof target,         uint32_t(framebuffer), 0, 0, box.getActualWidth(),
                                    box.getActualHeight(), RIVULET_AUTOMATIC};
        works = rivulet_world_draw(world_, &seen, &target, &why) == RIVULET_OK;
    }
    // OGRE's context must be current.
    void destroy() {
        rivulet_world_destroy(world_);
        rivulet_context_destroy(context_);
    }

  private:
    rivulet_context* context_ = nullptr;
    rivulet_world* world_ = nullptr;
};

void write(Ogre::RenderTarget& from, const std::string& path) {
    std::vector<uint8_t> rgb(size_t{3} * kWidth * kHeight);
    from.copyContentsToMemory(Ogre::Box(0, 0, kWidth, kHeight), Ogre::PixelBox(kWidth, kHeight, 1, Ogre::PF_BYTE_RGB, rgb.data()));
    FILE* file = std::fopen(path.c_str(), "wb");
    if (file == nullptr) return;
    std::fprintf(file, "P6 %d %d 255\n", kWidth, kHeight);
    std::fwrite(rgb.data(), 1, rgb.size(), file);
    std::fclose(file);
}

}  // namespace

int main(int count, char** arguments) {
    int frames = -1;
    bool dry = false;
    std::string picture;
    for (int k = 1; k < count; ++k) {
        if (std::strcmp(arguments[k], "--dry") == 0) dry = true;
        if (k + 1 < count && std::strcmp(arguments[k], "--frames") == 0) frames = std::atoi(arguments[k + 1]);
        if (k + 1 < count && std::strcmp(arguments[k], "--picture") == 0) picture = arguments[k + 1];
    }
    Ogre::LogManager logs;
    logs.createLog("", true, false, true);
    Ogre::Root root("", "", "");
    root.loadPlugin(OGRE_PLUGINS "/RenderSystem_GL3Plus");
    root.setRenderSystem(root.getAvailableRenderers().front());
    root.initialise(false);
    Ogre::RenderWindow& window = *root.createRenderWindow("Water", kWidth, kHeight, false);
    Ogre::ResourceGroupManager::getSingleton().initialiseAllResourceGroups();
    addMaterials();
    Ogre::SceneManager& scene = *root.createSceneManager();
    scene.getRootSceneNode()->attachObject(terrace(scene));
    Ogre::Camera& camera = *scene.createCamera("eye");
    Ogre::SceneNode& eye = *scene.getRootSceneNode()->createChildSceneNode(Ogre::Vector3(0.6F, 1.05F, 2.75F));
    eye.attachObject(&camera);
    eye.lookAt(Ogre::Vector3(0.6F, 0.154F, 0.6F), Ogre::Node::TS_WORLD);
    camera.setNearClipDistance(0.1F), camera.setFarClipDistance(15);
    camera.setFOVy(Ogre::Degree(42.08F)), camera.setAspectRatio(4.0F / 3);

    // Three targets of the same camera: the window, a texture, and a texture that a compositor fills from one of its own.
    Water water;
    std::vector<Ogre::RenderTarget*> targets = {&window};
    for (const char* name : {"texture", "compositor"})
        targets.push_back(
            Ogre::TextureManager::getSingleton()
                .createManual(name, "General", Ogre::TEX_TYPE_2D, kWidth, kHeight, 0, Ogre::PF_BYTE_RGBA, Ogre::TU_RENDERTARGET)
                ->getBuffer()
                ->getRenderTarget());
    for (Ogre::RenderTarget* target : targets) target->addViewport(&camera)->setBackgroundColour(Ogre::ColourValue(0.66F, 0.79F, 0.90F));
    Ogre::CompositionTechnique& way = *Ogre::CompositorManager::getSingleton().create("copy", "General")->createTechnique();
    way.createTextureDefinition("drawn")->formatList.push_back(Ogre::PF_BYTE_RGBA);
    Ogre::CompositionTargetPass& drawn = *way.createTargetPass();
    drawn.setOutputName("drawn"), drawn.setInputMode(Ogre::CompositionTargetPass::IM_PREVIOUS);
    Ogre::CompositionPass& quad = *way.getOutputTargetPass()->createPass(Ogre::CompositionPass::PT_RENDERQUAD);
    quad.setMaterialName("copy");
    quad.setInput(0, "drawn");
    Ogre::Viewport* composed = targets[2]->getViewport(0);
    Ogre::CompositorInstance& instance = *Ogre::CompositorManager::getSingleton().addCompositor(composed, "copy");
    instance.setEnabled(true);
    root.renderOneFrame();
    if (!dry && !water.create()) return std::fprintf(stderr, "embed_ogre: %s\n", water.why.message), 1;
    for (Ogre::RenderTarget* target : {targets[0], targets[1], instance.getRenderTarget("drawn")}) target->addListener(&water);
    for (int frame = 0; frame != frames && !window.isClosed() && (dry || water.works); ++frame) {
        water.step();
        root.renderOneFrame();
    }
    if (!dry && !water.works) return std::fprintf(stderr, "embed_ogre: %s\n", water.why.message), 1;
    if (!picture.empty()) {
        write(window, picture);
        write(*targets[1], picture + ".texture");
        write(*targets[2], picture + ".compositor");
        water.shown = false;
        root.renderOneFrame();
        write(window, picture + ".after");
    }
    water.destroy();
    return 0;
}
