// PlacedFlow: a SurfaceFlow in a world: where its skin is, where a drop in the air meets it, and how the drop lands.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "fluid/flow/skin_search.h"
#include "fluid/flow/surface_flow.h"

namespace rivulet {

// A drop that hangs, in the world: about its centre line, which leaves the skin along `axis` and leans by `lean` times its length at the
// tip.
struct HungDrop {
    dvec3 foot{0.0}, axis{0.0}, lean{0.0};  // m, of the middle of the plane of its foot; unit; 1
    DropProfile profile;                    // m, along the axis
    double opacity = 1;

    dvec3 tip() const { return foot + profile.length * (axis + 0.5 * lean); }
    dvec3 down() const { return glm::normalize(axis + lean); }  // at the tip
};

// Appends the five rows of a hanging drop to FluidView::pendants. absorption: 1/m, of its liquid.
void addPendant(const HungDrop& drop, const vec3& absorption, std::vector<vec4>& rows);

// A drop in the air: a ball.
struct AirDrop {
    dvec3 position{0.0}, velocity{0.0};  // m, m/s, in the world
    uint32_t picolitres = 0;
    uint32_t skin = 0;                  // index of the skin that it left: it has that skin's liquid and wind
    std::optional<HungDrop> hung = {};  // that let go: what it was, `age` before
    double age = 0;                     // s
    // Set by AirDrops: the number of the drop, in the order in which drops were added, and of the last query for water on its path.
    uint64_t number = 0, asked = 0;
    // The end of its way, which waits for the answers to its questions: it stays in sight there. No skin: it is below the floor.
    struct End {
        dvec3 to{0.0};
        std::optional<size_t> skin = {};
        SkinSearch::Hit where = {};
    };
    std::optional<End> end = {};
};
double radiusOf(const AirDrop& drop);  // m

class PlacedFlow {
  public:
    // The skin's frame -> the world at a time (s): turned and moved, not scaled.
    using Motion = std::function<dmat4(double time)>;
    // The skin is where `motion` has it at t = 0. `flow` and what `motion` reads must outlive it.
    PlacedFlow(SurfaceFlow& flow, Motion motion);

    void moveTo(double time);  // s: the skin is where its motion has it then
    // Where a saved one was, of a flow that was restored, too.
    void restore(double time, const dmat4& toWorld);

    // Where a path through the world first meets the skin. Nothing: nowhere. The skin has the shape that it has now; as a whole it is where
    // it is now when the path begins, and where its motion has it at `then` (s) when it ends. The shape is SurfaceFlow::shape()'s.
    std::optional<SkinSearch::Hit> meets(const dvec3& from, const dvec3& to, double then);
    // The point of the skin nearest to `x`, m in the skin's frame, in that shape.
    SkinPoint nearest(const vec3& x);
    // A drop that comes to rest on the skin there.
    void land(const SkinSearch::Hit& where, const AirDrop& drop);

    // A drop that hangs from the skin, where the skin is now. Not in thesis mode.
    HungDrop hung(const HangingDrop& drop) const;
    std::vector<HungDrop> hanging() const;  // does not wait; on a GPU some steps late

    SurfaceFlow& flow() { return *flow_; }
    const SurfaceFlow& flow() const { return *flow_; }
    const SkinSearch& search() const { return search_; }  // the skin as meets() last saw it, at first as it is at rest; in its own frame
    const dmat4& toWorld() const { return toWorld_; }
    double time() const { return time_; }  // s, at which it is there
    Bounds bounds() const;                 // m, in the world, of search()

  private:
    void look();

    SurfaceFlow* flow_;
    Motion motion_;
    SkinSearch search_;
    dmat4 toWorld_{1.0};
    double time_ = 0;
    uint64_t seen_ = UINT64_MAX, seenFrom_ = 0;  // SurfaceFlow::Shape's, of the shape that search_ has; UINT64_MAX: not known
};

// The first of `skins` that a path meets. skin: its index there; skins.size(): none.
struct FirstMet {
    size_t skin = 0;
    SkinSearch::Hit where;
};
FirstMet firstMet(std::span<PlacedFlow* const> skins, const dvec3& from, const dvec3& to, double then);

}  // namespace rivulet
