// SurfaceTrial: the scenes of the case `surface` and its chart: spheres and planes, one moment of a dam break and a pool at rest, each
// drawn with every requested look.
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

// A way to draw the water.
struct SurfaceLook {
    std::string filter;        // a row of filters(), or kSurfaceReference: the ray-marched iso-surface
    std::string quality = {};  // look.quality; "" = that of the scene
    float reach = 0;           // of the smoothing, in spacings; 0 = that of the scene
};
inline constexpr const char* kSurfaceReference = "reference";
constexpr double kMomentShare = 0.3;  // finished share of the case when the moment is reached

struct ShapeErrors {
    const SurfaceShape* shape;  // owned by the trial
    SurfaceErrors errors;
};
struct MomentErrors {
    SurfaceErrors errors;
    double flip = 0;
};

struct DrawTimes {
    Spread frame, water;  // wall ms until a picture is drawn: in total, and beyond the scene without water
};
struct StillPool {
    std::vector<double> flicker;  // of 255, one per look
    double speed = 0;             // mm/s, rms over its particles in the first picture
};

class SurfaceTrial {
  public:
    // Error: there is no OpenGL (failed); an assignment is invalid (badInput).
    static Result<SurfaceTrial> create(const CaseSettings& settings);

    Result<std::vector<ShapeErrors>> shapes(const SurfaceLook& look);
    // One moment of a dam break: the surface and the picture compared with the reference. `look` must not be the reference.
    Result<MomentErrors> moment(const SurfaceLook& look);
    // The time of a picture of that moment; the reference is drawn only once.
    Result<DrawTimes> times(const SurfaceLook& look);
    // The change of the picture of a pool at rest while the simulation continues.
    Result<StillPool> flicker(std::span<const SurfaceLook> looks, int stillFrames);

    // Pixels.
    int width() const { return settings_.quick ? 320 : 640; }
    int height() const { return width() * 9 / 16; }
    size_t momentParticles() const { return now_.at.size(); }
    std::string drawnBy() const;               // the renderer's name from OpenGL
    bool goOn(double share);                   // reports the finished share; false: CaseSettings::goOn asked to stop
    bool stopped() const { return stopped_; }  // by CaseSettings::goOn: the last result is incomplete

  private:
    SurfaceTrial(const CaseSettings& settings, SurfaceProbe probe) : settings_(settings), probe_(std::move(probe)) {}
    FrameView viewOf(const SceneFile& scene, const Session& session) const;
    Result<SurfaceMap> drawn(const SplatSet& splats, const FrameView& view, const SceneFile& scene);
    Result<std::vector<uint8_t>> pictureOf(const SceneFile& scene);
    Status reachMoment();
    // ms of each of `count` draws of the moment, after `before` draws that are not counted.
    Result<std::vector<double>> drawMs(const FrameView& view, const SceneFile& scene, const FluidView& fluid, int before, int count);

    CaseSettings settings_;
    SurfaceProbe probe_;  // declared first: the members below use its context
    SceneFile scene_;     // the dam break; shapes use its look
    std::vector<SurfaceShape> shapes_;
    std::unique_ptr<SceneRenderer> renderer_;

    // The moment; null: not reached yet.
    std::unique_ptr<Session> session_;
    FluidUpload upload_;
    SplatSet now_;
    FrameView view_;
    SurfaceMap reference_;
    std::vector<uint8_t> referencePicture_;
    bool stopped_ = false;
};

}  // namespace rivulet
