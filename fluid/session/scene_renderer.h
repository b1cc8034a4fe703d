// SceneRenderer: one frame of a scene: shadow -> depth -> opaque -> fluid -> tonemap. Window, headless runs and tests share it.
//
//     Result<std::unique_ptr<SceneRenderer>> r = SceneRenderer::create(ShaderFiles::developer());
//     Status drawn = (*r)->draw(frameViewOf(camera, settings.light, width, height, time), fluid, scene, settings);
//     (*r)->present(0, width, height);  or  (*r)->pixels();
//
// Needs a current OpenGL 4.5 context throughout, its destruction included.
#pragma once

#include <array>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <vector>

#include "engine/render/environment_map.h"
#include "engine/render/lens.h"
#include "engine/render/passes.h"
#include "engine/scene/camera.h"
#include "engine/scene/scene.h"
#include "fluid/render/renderers.h"
#include "fluid/scene/scene_file.h"
#include "fluid/sim/world/fluid_world.h"

namespace rivulet {

// The scene file's camera, with planes that hold `bounds` (m, world).
Camera cameraOf(const CameraParams& params, const Bounds& bounds);
// The picture that surrounds the scene; nothing: the studio. Error (badInput): the picture is missing or damaged.
Result<std::optional<HdrImage>> surroundingsOf(const SceneFile& scene);
// A window of 0 pixels gives a view of 1.
FrameView frameViewOf(const Camera& camera, const LightParams& light, int width, int height, double time);

class SceneRenderer {
  public:
    // `surroundings`: lights the scene beside the key light and is its background; null: the studio.
    // `log`: whether the cache of surroundings can be used. Error (failed): a shader does not compile, or is missing.
    static Result<std::unique_ptr<SceneRenderer>> create(const ShaderFiles& files, const HdrImage* surroundings = nullptr,
                                                         const Log& log = {});

    // Draws into its own picture, of the view's size. Error: an unknown renderer or colouring (badInput); out of GPU memory (failed).
    Status draw(const FrameView& view, const FluidView& fluid, const Scene& scene, const SceneFile& settings);

    // Of a renderer that takes seconds: receives the share that is done, from any thread; false: the rest of the picture may stay empty.
    void onProgress(std::function<bool(double)> progress) { progress_ = std::move(progress); }

    // The last picture, scaled into a framebuffer of this size (0: the window).
    void present(unsigned framebuffer, int width, int height) const;
    // The last picture: RGBA8, sRGB, top row first, alpha 255. Waits for the GPU.
    std::vector<uint8_t> pixels() const;
    void finish();  // waits for the GPU: times() are then the last picture's, and onSpan() has received all
    int width() const { return picture_.desc().width; }
    int height() const { return picture_.desc().height; }

    // GPU time per pass, some frames late.
    const std::vector<PassTime>& times() const { return pool_.times(); }
    void onSpan(SpanSink sink) { pool_.onSpan(std::move(sink)); }  // receives each pass, as late
    // The last picture's frame graph. Nothing, unless describe(true) was called before it was drawn.
    const std::optional<gpu::FrameGraphDescription>& description() const { return description_; }
    void describe(bool yes) { describes_ = yes; }
    // Whether look.quality auto means fast; fine by default.
    void hurry(bool yes) { hurries_ = yes; }
    // Call once before drawing if it was made in another context, which shares its objects with the current one.
    void contextChanged() { fluid_.contextChanged(); }
    // Reads the shaders again. Returns how many programs changed. Error: as create; all programs stay as they were.
    Result<size_t> reload();

  private:
    SceneRenderer() = default;
    Status prepare(const FrameView& view, const Scene& scene);
    Result<DrawnMesh> drawnOf(const Scene& scene, size_t node, const mat4& toWorld, const FluidView& fluid);
    Status readPoses(const FluidView& fluid, const Scene& scene);
    void addShadows(gpu::FrameGraph& graph, const std::vector<DrawnMesh>& meshes, const mat4& projection, const Scene& scene,
                    const FluidView& fluid, LightMaps& light);

    RenderPrograms render_;
    LensPrograms lens_;
    FluidPrograms fluid_;
    gpu::TransientPool pool_;
    gpu::Buffer frame_, coarse_;                            // FrameParams; for half the resolution
    gpu::Texture picture_;                                  // the last frame
    std::array<gpu::Texture, 2> shadowSharp_, shadowSoft_;  // and those of fast quality
    std::vector<mat4> shadowOf_;  // the content of the shadow maps: the light's projection, then a matrix per mesh
    std::vector<const GpuMesh*> shadowMeshes_;
    gpu::Texture nothing_;                     // bound where the scene has no light map
    std::vector<uint64_t> shadowVersions_;     // of their deformers
    std::shared_ptr<const void> shadowPoses_;  // FluidView::bodiesMoved
    uint32_t shadowVersion_ = 0;
    gpu::TextureName poseRows_;  // FluidView::bodies as a texture
    struct MeshKey {
        std::shared_ptr<const Mesh> mesh;
        std::weak_ptr<const Deformer> deformer;  // weak: a deformer must not outlive its device, but this may
        bool operator<(const MeshKey& other) const {
            return mesh != other.mesh ? mesh < other.mesh : deformer.owner_before(other.deformer);
        }
    };
    static MeshKey keyOf(const Node& node) {
        return {node.mesh, node.deformed ? node.deformed->of : std::weak_ptr<const Deformer>(node.deformer)};
    }
    std::map<MeshKey, GpuMesh> meshes_;
    GpuImages images_;
    std::function<bool(double)> progress_ = [](double) { return true; };
    gpu::Texture surroundings_;  // empty: the studio
    std::array<vec4, 9> matteLight_{};
    bool hurries_ = false, describes_ = false;
    std::optional<gpu::FrameGraphDescription> description_;
};

}  // namespace rivulet
