#include <fmt/format.h>

#include "demos/rivulet/cli.h"
#include "engine/compute/device_cl.h"
#include "engine/core/json.h"
#include "engine/core/message_line.h"
#include "fluid/render/backend.h"
#include "fluid/render/filters.h"
#include "fluid/render/renderers.h"
#include "fluid/scene/scene_file.h"
#include "fluid/sim/methods/method.h"
#include "fluid/sim/sources/liquids.h"
#include "fluid/voxel/voxelize.h"

namespace rivulet {

namespace {

void row(std::string_view name, std::string_view doc) { fmt::print("{:<18}{}\n", messageLine(name), messageLine(doc)); }

template <class Row>
void rows(const Table<Row>& table) {
    for (const Row& r : table.rows) row(r.name, r.doc);
}

void scenes() {
    for (const SceneListing& scene : listScenes()) {
        row(scene.name, scene.doc);
        fmt::print("{:<18}{}\n", "", printable(scene.path));
    }
}

void liquidRows() {
    for (const LiquidRow& l : liquids().rows) {
        row(l.name, l.doc);
        fmt::print("{:<18}density {} kg/m^3, viscosity {} Pa s, surface tension {} N/m\n", "", l.density, l.viscosity, l.surfaceTension);
        fmt::print("{:<18}absorption {}, {}, {} 1/m, scattering {:.2g}, {:.2g}, {:.2g} 1/m (red, green, blue), refractive index {}\n", "",
                   l.absorption.x, l.absorption.y, l.absorption.z, l.scattering.x, l.scattering.y, l.scattering.z, l.refractiveIndex);
        fmt::print("{:<18}sources: {}\n", "", l.source);
    }
}

void devices() {
    rows(backends());
    const std::vector<ClDeviceListing> all = listClDevices();
    for (size_t k = 0; k < all.size(); ++k) row(fmt::format("cl --device {}", k + 1), all[k].sentence);
}

struct ListRow {
    const char* name;
    const char* doc;
    void (*print)();
};
Table<ListRow> lists() {
    static const ListRow table[] = {
        {"scenes", "scene files of the program, and those in the folders of RIVULET_ASSETS", scenes},
        {"methods", "values of fluid.method: how the pressure is computed", [] { rows(methods()); }},
        {"liquids", "values of fluid.liquid: material properties in SI units, with their sources", liquidRows},
        {"renderers", "values of look.renderer: how the water is drawn", [] { rows(renderers()); }},
        {"filters", "values of look.filter: how the depth of the particles is smoothed to a surface", [] { rows(filters()); }},
        {"voxels", "values of voxelize --mode: how a mesh is converted to voxels", [] { rows(voxelModes()); }},
        {"devices", "values of --backend and --device", devices},
    };
    return {table};
}

}  // namespace

int listVerb(const Arguments& arguments) {
    ArgumentReader reader("list", "Lists the names that scene files and options accept. Without an argument it prints all lists.");
    std::string what;
    bool parameters = false;
    std::string doc = "one of:";
    for (const ListRow& list : lists().rows) doc += fmt::format(" {}", list.name);
    reader.positional("WHAT", doc, what, false);
    reader.flag("--parameters", "print every parameter of a scene file as a Markdown table", parameters);
    if (std::optional<int> code = reader.read(arguments)) return *code;

    if (parameters) {
        SceneFile scene;
        fmt::print("{}", describeParams([&scene](ParamVisitor& v) { scene.visit(v); }));
        return kDone;
    }
    if (!what.empty()) {
        if (Status known = checkWord("list", what, lists().names()); !known) return report(known.error());
        lists().find(what)->print();
        return kDone;
    }
    for (const ListRow& list : lists().rows) {
        fmt::print("{}: {}\n\n", list.name, list.doc);
        list.print();
        fmt::print("\n");
    }
    return kDone;
}

}  // namespace rivulet
