#include <gtest/gtest.h>

#include "engine/core/table.h"
#include "tests/unit/core_sample.h"

namespace rivulet::core_set_test {

namespace {

std::string set(Sample& sample, std::string_view assignment) {
    const Status status = setParam(assignment, visiting(sample));
    return status ? "" : status.error().message;
}

std::string errorOf(std::string_view assignment) {
    Sample sample;
    sample.colliders.resize(2);
    return set(sample, assignment);
}

}  // namespace

TEST(SetParam, ReachesEveryKindOfValueAndNothingElse) {
    Sample s;
    EXPECT_EQ(set(s, "name=a=b [c], d"), "");
    EXPECT_EQ(set(s, "fluid.spacing=0.25"), "");
    EXPECT_EQ(set(s, "fluid.substeps= 7 "), "");
    EXPECT_EQ(set(s, "fluid.walls=false"), "");
    EXPECT_EQ(set(s, "fluid.method=wcsph_thesis"), "");
    EXPECT_EQ(set(s, "fluid.gravity=1,-2.5, 3"), "");
    EXPECT_EQ(set(s, "colliders.0.mesh=cow.obj"), "");
    EXPECT_EQ(set(s, "colliders[1].tint=[0, 0.5, 1]"), "");
    EXPECT_EQ(set(s, "colliders.0.size=3"), "");
    Sample expected;
    expected.name = "a=b [c], d";
    expected.fluid = {0.25F, 7, false, "wcsph_thesis", vec3(1.0F, -2.5F, 3.0F)};
    expected.colliders = {{3.0F, "cow.obj", SampleItem{}.tint, {}}, {0.5F, "", vec3(0.0F, 0.5F, 1.0F), {}}};
    EXPECT_EQ(s, expected);
}

TEST(SetParam, ListsNest) {
    Sample s;
    s.colliders.resize(3);
    for (SampleItem& item : s.colliders) item.parts.resize(2);
    Sample expected = s;
    expected.colliders[1].parts.resize(3);
    expected.colliders[1].parts[0].count = 5;
    expected.colliders[1].parts[2].count = 7;
    expected.colliders[2].size = 4;
    EXPECT_EQ(set(s, "colliders.1.parts.0.count=5"), "");
    EXPECT_EQ(set(s, "colliders.1.parts.2.count=7"), "");
    EXPECT_EQ(set(s, "colliders.2.size=4"), "");
    EXPECT_EQ(set(s, "colliders.0.parts.0.cuont=5"),
              "colliders[0].parts[0].cuont is not a parameter; did you mean colliders[0].parts[0].count?");
    EXPECT_EQ(set(s, "colliders.0.parts.1=5"),
              "colliders[0].parts is a list; name an item and its parameter, as in colliders[0].parts.0.name=value");
    EXPECT_EQ(s, expected);
}

TEST(SetParam, AnEmptyTextIsText) {
    Sample s;
    EXPECT_EQ(set(s, "name="), "");
    EXPECT_EQ(s.name, "");
}

TEST(SetParam, RefusesWithPathAndRemedy) {
    const std::pair<const char*, const char*> refusals[] = {
        {"fluid.spacingg=1", "fluid.spacingg is not a parameter; did you mean fluid.spacing?"},
        {"spacing=1", "spacing is not a parameter; did you mean fluid.spacing?"},
        {"flu.spacing=1", "flu is not a parameter; did you mean fluid?"},
        {"fluid.qqqqqq=1", "fluid.qqqqqq is not a parameter; known here: spacing, substeps, walls, method, gravity"},
        {"colliders.1.mash=x", "colliders[1].mash is not a parameter; did you mean colliders[1].mesh?"},
        {"colliders.3.mesh=x", "colliders has 2 items; the index must be between 0 and 2 (which appends one), but is 3"},
        {"colliders.-1.mesh=x", "colliders has 2 items; the index must be between 0 and 2 (which appends one), but is -1"},
        {"colliders.99999999999999999999.mesh=x",
         "colliders has 2 items; the index must be between 0 and 2 (which appends one), but is 99999999999999999999"},
        {"colliders=x", "colliders is a list; name an item and its parameter, as in colliders.0.name=value"},
        {"colliders.0=x", "colliders is a list; name an item and its parameter, as in colliders.0.name=value"},
        {"fluid=x", "fluid is a group of parameters; name one of them"},
        {"fluid.spacing.x=1", "fluid.spacing is a single value; it has no members"},
        {"fluid.spacing=2", "fluid.spacing is 2 m, must be between 0.0005 and 1 m"},
        {"fluid.spacing=nan", "fluid.spacing is nan, must be a number between 0.0005 and 1 m"},
        {"fluid.spacing=", "fluid.spacing is empty, must be a number between 0.0005 and 1 m"},
        {"fluid.spacing=1 m", "fluid.spacing is 1 m, must be a number between 0.0005 and 1 m"},
        {"fluid.substeps=1.5", "fluid.substeps is 1.5, must be a whole number between 1 and 64"},
        {"fluid.gravity=1,2", "fluid.gravity is 1,2, must be three numbers [x, y, z], each between -1000 and 1000 m/s^2"},
        {"fluid.gravity=1,2,inf", "fluid.gravity is 1,2,inf m/s^2, must be between -1000 and 1000 m/s^2 in each component"},
        {"fluid.method=wcsp", "fluid.method is \"wcsp\", must be one of wcsph, wcsph_thesis; did you mean wcsph?"},
        {"fluid.walls=yes", "fluid.walls is yes, must be true or false"},
        {"fluid.spacing", "fluid.spacing is not of the form path.to.param=value"},
        {"=3", "=3 is not of the form path.to.param=value"},
        {"", "an empty text is not of the form path.to.param=value"},
        {".=3", " is not a parameter; known here: name, free, fluid, colliders"},
    };
    for (const auto& [assignment, error] : refusals) EXPECT_EQ(errorOf(assignment), error) << assignment;
}

TEST(SetParam, AWrongValueChangesNothing) {
    for (const char* assignment : {"fluid.spacing=2", "fluid.gravity=1,2,nan", "fluid.method=x", "fluid.substeps=0", "fluid.walls=2"}) {
        Sample s;
        EXPECT_NE(set(s, assignment), "");
        EXPECT_EQ(s, Sample{}) << assignment;
    }
}

TEST(NearestName, FindsTheIntendedName) {
    const std::vector<std::string> names = {"viscosity", "artificialViscosity", "spacing", "restDensity", "cfl"};
    EXPECT_EQ(nearestName("viscocity", names), "viscosity");
    EXPECT_EQ(nearestName("SPACING", names), "spacing");
    EXPECT_EQ(nearestName("spaicng", names), "spacing");
    EXPECT_EQ(nearestName("rest_density", names), "restDensity");
    EXPECT_EQ(nearestName("visc", names), "viscosity");
    EXPECT_EQ(nearestName("clf", names), "");
    EXPECT_EQ(nearestName("gravity", names), "");
    EXPECT_EQ(nearestName("", names), "");
    EXPECT_EQ(nearestName(std::string(100000, 's'), names), "");
    EXPECT_EQ(nearestName("spacing", {}), "");
}

TEST(DescribeParams, NamesEveryParamWithUnitRangeAndDefault) {
    Sample s;
    const std::string page = describeParams(visiting(s));
    for (const char* row : {"| `name` |  |  | `\"unnamed\"` | title |\n", "| **fluid** |  |  |  | what flows |\n",
                            "| `fluid.spacing` | m | between 0.0005 and 1 | `0.02` | distance of particles |\n",
                            "| `fluid.substeps` |  | whole, between 1 and 64 | `4` | a frame |\n",
                            "| `fluid.walls` |  | true or false | `true` | a \\| b |\n",
                            "| `fluid.method` |  | one of wcsph, wcsph_thesis | `\"wcsph\"` | pressure (fixed) |\n",
                            "| `fluid.gravity` | m/s^2 | between -1000 and 1000 | `[0, -9.81, 0]` | downwards |\n",
                            "| **colliders** |  |  | `[]` | solids |\n", "| `colliders[].mesh` |  |  | `\"\"` | file |\n",
                            "| `colliders[].parts[].count` |  | whole, between 0 and 9 | `1` | how many |\n"})
        EXPECT_NE(page.find(row), std::string::npos) << row << page;
}

}  // namespace rivulet::core_set_test
