// Water in OpenSceneGraph: a Drawable among the objects of a scene graph; one stands in front of the water, others are seen through it.
// embed_osg [--frames N] [--picture FILE.ppm] [--dry]: stops after N frames and writes the last one; --dry draws no water.
#include <algorithm>
#include <cstdio>
#include <osg/Image>
#include <osgViewer/Viewer>

#include <rivulet/rivulet.h>

#include "terrace.h"

namespace {

class Water : public osg::Drawable {
  public:
    Water() {
        setSupportsDisplayList(false);
        getOrCreateStateSet()->setRenderBinDetails(10, "RenderBin");  // after opaque objects, which are seen through the water
    }
    bool works() const { return works_; }
    // OSG computes its near and far plane from it, m.
    osg::BoundingBox computeBoundingBox() const override { return {0, 0, 0, 1.2F, 1.2F, 1.2F}; }
    // rivulet.h restores the OpenGL state, so that OSG's cached state stays valid.
    void drawImplementation(osg::RenderInfo& info) const override {
        rivulet_error why{};
        if (works_ && draw(*info.getState(), &why) == RIVULET_OK) return;
        if (works_) std::fprintf(stderr, "embed_osg: %s\n", why.message);
        works_ = false;
    }
    // The window's context must be current.
    void destroy() {
        rivulet_world_destroy(world_);
        rivulet_context_destroy(context_);
    }

  private:
    rivulet_status create(rivulet_error* why) const {
        rivulet_context_options options{};
        options.size = sizeof options;
        options.find = [](const char* name) { return reinterpret_cast<rivulet_function>(osg::getGLExtensionFuncPtr(name)); };
        options.clouds = 0.3F;
        std::copy_n(osg::Vec3(0.55F, 0.66F, 0.76F).ptr(), 3, options.sky_horizon);
        std::copy_n(osg::Vec3(0.20F, 0.34F, 0.56F).ptr(), 3, options.sky_zenith);
        if (const rivulet_status made = rivulet_context_create(&options, &context_, why); made != RIVULET_OK) return made;
        rivulet_world_options scene{};
        scene.size = sizeof scene;
        scene.json = R"({"fluid": {"spacing": 0.025, "box": {"max": [1.2, 1.2, 1.2]}, "blocks": [{"max": [1.2, 0.3, 1.2]},
            {"shape": "ball", "min": [0.25, 0.5, 0.45], "max": [0.55, 0.8, 0.75]}]}})";
        return rivulet_world_create(context_, &scene, &world_, why);
    }
    rivulet_status draw(const osg::State& state, rivulet_error* why) const {
        if (world_ == nullptr)
            if (const rivulet_status made = create(why); made != RIVULET_OK) return made;
        if (const rivulet_status stepped = rivulet_world_step(world_, nullptr, 1.0 / 60, why); stepped != RIVULET_OK) return stepped;
        // OSG combines model and view in one matrix, so the water is placed by the nodes above this one.
        const osg::Matrixf modelView(state.getModelViewMatrix()), projection(state.getProjectionMatrix());
        double side = 0, nearPlane = 0, farPlane = 0;
        state.getProjectionMatrix().getFrustum(side, side, side, side, nearPlane, farPlane);
        GLint framebuffer = 0;
        glGetIntegerv(0x8CA6, &framebuffer);  // GL_DRAW_FRAMEBUFFER_BINDING: OSG may draw into a texture
        const osg::Viewport& box = *state.getCurrentViewport();
        rivulet_view view{};
        view.size = sizeof view;
        view.view = modelView.ptr();
        view.projection = projection.ptr();
        view.near_plane = float(nearPlane);
        view.far_plane = float(farPlane);
        const rivulet_target target{sizeof target,    uint32_t(framebuffer), int(box.x()),     int(box.y()),
                                    int(box.width()), int(box.height()),     RIVULET_AUTOMATIC};
        return rivulet_world_draw(world_, &view, &target, why);
    }
    mutable rivulet_context* context_ = nullptr;
    mutable rivulet_world* world_ = nullptr;
    mutable bool works_ = true;
};

// Keeps the pixels of the last frame.
struct Keep : osg::Camera::DrawCallback {
    osg::ref_ptr<osg::Image> image = new osg::Image;
    void operator()(osg::RenderInfo&) const override { image->readPixels(0, 0, 640, 480, GL_RGB, GL_UNSIGNED_BYTE, 1); }
};

}  // namespace

int main(int count, char** arguments) {
    osg::ArgumentParser options(&count, arguments);
    int frames = -1;
    std::string picture;
    options.read("--frames", frames);
    options.read("--picture", picture);
    osg::ref_ptr<osg::Group> scene = terrace();
    osg::ref_ptr<Water> water = new Water;
    if (!options.read("--dry")) scene->addChild(water);
    osg::DisplaySettings::instance()->setNumMultiSamples(4);
    osgViewer::Viewer viewer;
    viewer.setThreadingModel(osgViewer::Viewer::SingleThreaded);
    viewer.setUpViewInWindow(0, 0, 640, 480);
    viewer.setLightingMode(osg::View::SKY_LIGHT);
    viewer.getLight()->setPosition({0.4F, 0.8F, 0.45F, 0});
    viewer.getLight()->setAmbient({0.34F, 0.36F, 0.40F, 1});
    viewer.getLight()->setDiffuse({0.72F, 0.70F, 0.65F, 1});
    viewer.setSceneData(scene);
    osg::Camera& camera = *viewer.getCamera();
    camera.setClearColor({0.66F, 0.79F, 0.90F, 1});
    camera.setViewMatrixAsLookAt({0.6, 1.05, 2.75}, {0.6, 0.154, 0.6}, osg::Y_AXIS);
    camera.setProjectionMatrixAsPerspective(42.08, 640.0 / 480, 0.1, 15);
    viewer.realize();
    osg::ref_ptr<Keep> kept = new Keep;
    for (int frame = 0; frame != frames && !viewer.done() && water->works(); ++frame) {
        if (frame + 1 == frames && !picture.empty()) camera.setFinalDrawCallback(kept);
        viewer.frame();
    }
    FILE* file = picture.empty() ? nullptr : std::fopen(picture.c_str(), "wb");
    if (file != nullptr) {
        std::fprintf(file, "P6 640 480 255\n");
        for (int row = 479; row >= 0; --row) std::fwrite(kept->image->data(0, row), 3, 640, file);
        std::fclose(file);
    }
    if (camera.getGraphicsContext() == nullptr || !camera.getGraphicsContext()->makeCurrent()) return 1;
    water->destroy();
    camera.getGraphicsContext()->releaseContext();
    return water->works() ? 0 : 1;
}
