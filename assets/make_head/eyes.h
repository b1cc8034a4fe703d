// Eyes and lids. Points near an eye have polar coordinates about the eyeball's centre: two angles, and the height above the surface (sclera
// and cornea), so that lids stay on the eye when they slide.
#pragma once

#include <string>

#include "assets/make_head/surface.h"

namespace rivulet::head {

inline constexpr double kEyeRadius = 1.2, kLimbusRadius = 0.59, kLidGap = 0.034;
inline constexpr double kInward = 0.03;  // radians by which each eye turns towards the other

// A point by an eye: angle outward, angle up, and height above sclera or cornea.
struct EyePoint {
    double out = 0, up = 0, height = 0;
};

struct Eye {
    double side = 1;  // +1 the subject's left
    dvec3 centre{0};
    std::vector<uint32_t> loop;                // the lid's outer edge: outer corner, lower lid, inner corner, upper lid
    std::vector<std::vector<uint32_t>> rings;  // its margin, from the edge inward: as many vertices a ring
    std::vector<EyePoint> lower, upper;        // margins at rest, from the inner corner to the outer

    EyePoint seen(dvec3 p) const;
    dvec3 placed(const EyePoint& e) const;
    // Both lids moved by a share of the way to the line where they meet; 1, 1 closes the eye. Points far from the lids do not move; points
    // of `onMargin` slide together.
    dvec3 lidsMoved(dvec3 p, bool upperLid, bool onMargin, double upperShare, double lowerShare) const;
    // A point of a lid, raised or lowered by as much as the surface below it when the eye turns: radians to the left and up.
    dvec3 raisedOver(dvec3 p, dvec2 gaze) const;
    double closingLine(double out) const;
    double margin(bool upperLid, double out) const;
};

// A part with its own material beside the skin.
struct Part {
    std::string name, material;
    std::vector<dvec3> positions, normals;
    std::vector<dvec2> uvs;
    std::vector<Triangle> triangles;
    std::vector<std::vector<dvec3>> morphs;  // displacements, one list a target; may be empty
};

// A vector from an eye's centre, when the eye turns up and then left; radians to the left and up.
dvec3 turned(dvec3 p, dvec2 gaze);
double eyeSurface(double out, double up);  // distance from the eyeball's centre to sclera or cornea
// Fits the lids of the subdivided head around both eyes and adds their margins.
std::array<Eye, 2> fitLids(Surface& head);
Part makeEyeball(const Eye& eye);
Part makeCornea(const Eye& eye);
Part makeCaruncle(const Eye& eye);
// The flesh in an inner corner, `t` of the margins' length from it, `v` from the lower lid to the upper: cm above its sheet, and how much
// of each part there is.
struct CornerFlesh {
    double height = 0, caruncle = 0, plica = 0, lump = 0;
    double along = 0;  // `t` where the slit is half as high, along the plica's crescent
};
CornerFlesh cornerFlesh(double t, double v);
inline constexpr double kFleshEnd = 0.215, kFleshTuck = 0.45;  // the sheet: of the margins' length; of the slit's height, behind either lid
// Its place in the eye's picture, in a corner that the map of the eyeball leaves free; `along`, `across`: 0..1 over the sheet.
dvec2 fleshUv(double along, double across);
// Of a vertex: the lash that it is of.
struct Lash {
    uint32_t root = 0;  // the nearest vertex of the skin
    bool upper = true;
    int number = 0;    // along its lid
    double along = 0;  // 0 at the root, 1 at the tip
};
Part makeLashes(const Eye& eye, const Surface& head, std::vector<Lash>& ofVertex);
// The positions of wet lashes. They stick together in groups of a few, with their tips touching.
std::vector<dvec3> clumped(const Part& lashes, const std::vector<Lash>& ofVertex);
// Droplets held by clumps; `full` becomes each vertex's place when the lid is full, at rest they are too small to see.
Part makeLashDrops(const Eye& eye, const Part& lashes, const std::vector<Lash>& ofVertex, std::vector<dvec3>& full,
                   std::vector<Lash>& ofDrop);

}  // namespace rivulet::head
