#include "fluid/render/fluid_look.h"

namespace rivulet {

namespace {
constexpr ViewRow kViewRows[] = {
    {"water", "the water", WaterView::water},
    {"normals", "the surface's normals: their parts along x, y, z as red, green, blue", WaterView::normals},
    {"depth", "the surface's depth, as the filter leaves it: white is near", WaterView::depth},
    {"spheres", "the particles' depth, before the filter", WaterView::spheres},
    {"thickness", "how much water there is along the line of sight", WaterView::thickness},
};
constexpr Table<ViewRow> kViews{kViewRows};
constexpr ColourRow kColourRows[] = {
    {"speed", "speed, up to 3 m/s", ColourBy::speed},
    {"density", "density, against the rest density", ColourBy::density},
    {"id", "a colour for each particle, which it keeps", ColourBy::id},
    {"dye", "the absorption of its liquid and dye", ColourBy::dye},
    {"normal", "the surface's normal: its parts along x, y, z as red, green, blue", ColourBy::normal, true},
    {"surface", "blue: a particle of the surface", ColourBy::surface, true},
};
constexpr Table<ColourRow> kColours{kColourRows};
}  // namespace

const Table<ViewRow>& waterViews() { return kViews; }
const Table<ColourRow>& colourings() { return kColours; }

}  // namespace rivulet
