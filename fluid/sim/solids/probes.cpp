#include "fluid/sim/solids/probes.h"

namespace rivulet {

void ProbeParams::visit(ParamVisitor& v) {
    static const std::vector<std::string> kinds = {"box", "collider", "body", "plane", "still", "rigid", "deforming"},
                                          faces = {"all", "-x", "+x", "-y", "+y", "-z", "+z"};
    v.value({.name = "name", .doc = "name of the probe in the results; each has its own"}, name);
    v.choice(
        {.name = "on",
         .doc = "what it measures; box: the walls of fluid.box; collider: an item of colliders, or a wall of a host; body: an item of "
                "bodies; for hosts in C++, plane, rigid, deforming: an item of Solids, still: the static field, or one of its surfaces"},
        on, kinds);
    v.choice({.name = "face", .doc = "face of the box that it measures"}, face, faces);
    v.value({"index", "", "number of the collider, body or solid, from 0; -1 = all of them", -1, 100000}, index);
    v.value({"min", "m", "lower corner of the region: only loads that act within it count", -kMaxPosition, kMaxPosition}, min);
    v.value({"max", "m", "upper corner of the region; with min on a wall of the box, the region may be flat", -kMaxPosition, kMaxPosition},
            max);
    v.value({"about", "m", "point to which the torque refers", -kMaxPosition, kMaxPosition}, about);
    v.value({"area", "m^2",
             "area over which the normal force gives the mean pressure; 0 = that of the region on one face of the box, else no pressure", 0,
             1.0e10, kLog},
            area);
}

}  // namespace rivulet
