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
constexpr double kMomentShare = 0.3, kSlowShare = 0.6;  // finished shares of the case when the moment and the slow motion are done

struct ShapeErrors {
    const SurfaceShape* shape;  // owned by the trial
    SurfaceErrors errors;
};
struct MomentErrors {
    SurfaceErrors free;       // of the free surface: without the pixels in which the reference shows a wall of the box
    SurfaceErrors errors;     // of the body of the water, without the spray
    double overlapOfAll = 1;  // of the silhouettes of body and spray; the reference has a ball in place of a particle's droplets
    double flip = 0;          // of the pictures, in the same light and with the same spray
};

struct DrawTimes {
    Spread frame, water;  // wall ms until a picture is drawn: in total, and beyond the scene without water
};
// How steady a series of pictures is; of 255.
struct Steadiness {
    double rms = 0;                // difference from the mean of all
    double change = 0, edges = 0;  // from picture to picture beyond the reference's, see UnexplainedChange; 0 for the reference
};
struct Watched {
    std::vector<Steadiness> looks;
    double speed = 0;  // mm/s, rms over the particles in the first picture
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
    // The change of the pictures while the simulation continues: of a pool at rest; of the dam break after its moment, in slow motion.
    Result<Watched> still(std::span<const SurfaceLook> looks, int frames);
    Result<Watched> slow(std::span<const SurfaceLook> looks, int frames);

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
    struct Seen {
        SurfaceMap map;             // where at least half of a pixel is covered
        std::vector<bool> covered;  // the same, with spray
    };
    Result<Seen> seen(const SplatSet& splats, const FrameView& view, const SceneFile& scene);
    Result<std::vector<uint8_t>> pictureOf(const SceneFile& scene);
    // Draws `frames` pictures, stepping `seconds` before each, with progress from `from` to `to`.
    struct Watch {
        Session& session;
        const SceneFile& scene;
        FrameView view;
        double seconds;
        int frames;
        double from, to;
    };
    Result<Watched> watch(const Watch& of, std::span<const SurfaceLook> looks);
    Status savePictures(const SurfaceLook& look, const Seen& seen, const std::vector<uint8_t>& picture) const;
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
    std::vector<bool> referenceCovered_;  // with spray
    std::vector<uint8_t> referencePicture_;
    bool stopped_ = false;
};

}  // namespace rivulet
