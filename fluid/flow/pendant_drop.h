// PendantDrop: the shape of a drop that hangs from a skin, the largest one, and how much of that falls.
#pragma once

#include <vector>

#include "engine/core/math.h"

namespace rivulet {

// A surface of revolution about the way down: at the share s of its length from the foot (0) to the tip (1) its radius r is
// r^2 = (1 - s) (x + y s + z s^2 + w s^3). A ball of diameter L is (0, L^2, 0, 0).
struct DropProfile {
    double length = 0;
    dvec4 swell{0.0};

    double square(double s) const { return (1 - s) * (swell.x + s * (swell.y + s * (swell.z + s * swell.w))); }
    double volume() const;
};

// By the equation of Young and Laplace (Bashforth and Adams 1883), for a foot that advances at one contact angle and recedes at another, as
// the drop grows. Where it would recede, it stays, until no larger volume is in equilibrium with it: then the drop falls. Lengths are over
// the capillary length sqrt(surface tension / (density x acceleration)), volumes over its cube. `bend`: the capillary length over the
// radius of the skin, that of a ball; a hollow counts as flat.
class PendantDrop {
  public:
    PendantDrop(double advancing, double receding);  // deg

    // 1 / the largest volume: x + y bend + z bend^2, for a bend of 1 at most, a tighter one being as 1.
    const dvec3& inverse() const { return inverse_; }
    double largest(double bend) const;
    // The share of the largest drop that falls: what a tip with that foot lets fall (Harkins and Brown 1919, as fitted by Heertjes, De Smet
    // and Witvoet 1971 for a foot of 0.3 to 1.2 of the cube root of the volume). The rest stays on the skin. x + y bend, as above.
    const dvec2& falling() const { return falling_; }
    double falls(double bend) const;
    // From the plane of its foot down. A smaller drop than a twentieth of the largest is as that, and a larger one as the largest.
    DropProfile profile(double bend, double volume) const;

  private:
    struct Row {
        double largest = 0, falls = 0;
        std::vector<DropProfile> shapes;  // by volume
    };
    std::vector<Row> rows_;  // by bend
    dvec3 inverse_{0.0};
    dvec2 falling_{0.0};
};

// The volume that falls from a tip of this radius: its weight is a share of 2 pi r x surface tension (Harkins and Brown 1919); lengths as
// above.
double fallenVolume(double foot);

}  // namespace rivulet
