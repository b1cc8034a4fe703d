// SurfaceTrial: what the case surface and its chart look at: spheres and levels, a dam break's moment and a pool at rest, each drawn in as
// many looks as are asked for.
#pragma once

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "fluid/render/fluid_upload.h"
#include "fluid/session/run_stats.h"
#include "fluid/session/scene_renderer.h"
#include "fluid/session/session.h"
#include "fluid/session/surface_probe.h"
#include "fluid/validate/physics_case.h"
#include "fluid/validate/surface_shapes.h"

namespace rivulet {

// A way to draw.
struct SurfaceLook {
    std::string filter;        // a row of filters(), or kSurfaceReference: the ray-marched iso-surface itself
    std::string quality = {};  // of look.quality; "" = as the scene says
    float reach = 0;           // spacings, of the smoothing; 0 = as the scene says
};
inline constexpr const char* kSurfaceReference = "reference";
constexpr double kMomentShare = 0.3;  // of the whole, when the moment is reached

struct ShapeErrors {
    const SurfaceShape* shape;  // the trial's
    SurfaceErrors errors;
};
struct MomentErrors {
    SurfaceErrors errors;
    double flip = 0;
};

struct DrawTimes {
    Spread frame, water;  // ms on the wall until it is drawn: all of it, and what it takes beyond the scene without water
};
struct StillPool {
    std::vector<double> flicker;  // of 255, a look each
    double fastest = 0;           // mm/s, of its particles when it is first drawn
};

class SurfaceTrial {
  public:
    // Error: there is no OpenGL (failed); an assignment makes no sense.
    static Result<SurfaceTrial> create(const CaseSettings& settings);

    Result<std::vector<ShapeErrors>> shapes(const SurfaceLook& look);
    // A dam that breaks, at a moment: the surface and the picture against the reference's, which is no look here.
    Result<MomentErrors> moment(const SurfaceLook& look);
    // What a picture of that moment takes; the reference's is drawn once.
    Result<DrawTimes> times(const SurfaceLook& look);
    // A pool that has come to rest goes on being simulated: what moves in its picture should not.
    Result<StillPool> flicker(std::span<const SurfaceLook> looks, int stillFrames);

    // Pixels.
    int width() const { return settings_.quick ? 320 : 640; }
    int height() const { return width() * 9 / 16; }
    size_t momentParticles() const { return now_.at.size(); }
    std::string drawnBy() const;               // OpenGL's name of the renderer
    bool goOn(double share);                   // tells how much is done; false: CaseSettings::goOn said that it is enough
    bool stopped() const { return stopped_; }  // by CaseSettings::goOn: what was found last is not whole

  private:
    SurfaceTrial(const CaseSettings& settings, SurfaceProbe probe) : settings_(settings), probe_(std::move(probe)) {}
    FrameView viewOf(const SceneFile& scene, const Session& session) const;
    Result<SurfaceMap> drawn(const SplatSet& splats, const FrameView& view, const SceneFile& scene);
    Result<std::vector<uint8_t>> pictureOf(const SceneFile& scene);
    Status reachMoment();
    // ms of each of `count` draws of the moment, after `before` that do not count.
    Result<std::vector<double>> drawMs(const FrameView& view, const SceneFile& scene, const FluidView& fluid, int before, int count);

    CaseSettings settings_;
    SurfaceProbe probe_;  // before what lives in its context
    SceneFile scene_;     // the dam break; shapes have its look
    std::vector<SurfaceShape> shapes_;
    std::unique_ptr<SceneRenderer> renderer_;

    // At the moment; null: not there yet.
    std::unique_ptr<Session> session_;
    FluidUpload upload_;
    SplatSet now_;
    FrameView view_;
    SurfaceMap reference_;
    std::vector<uint8_t> referencePicture_;
    bool stopped_ = false;
};

}  // namespace rivulet
