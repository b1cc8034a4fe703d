// The rows of methods and forces: properties that the program reads without comparing names.
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "fluid/sim/forces/force.h"

namespace rivulet::rows_test {
namespace {

TEST(ForceRows, RunInOrderAndNameTheRemedy) {
    std::set<std::string> names;
    int before = 0;
    for (const ForceRow& row : forces().rows) {
        EXPECT_TRUE(names.insert(row.name).second) << row.name;
        EXPECT_GE(row.order, before) << row.name;
        before = row.order;
        EXPECT_NE(std::string(row.remedy), "") << row.name;
        EXPECT_TRUE(row.on != nullptr && row.make != nullptr) << row.name;
    }
    EXPECT_EQ(std::string(forces().rows.back().name), "viscosity") << "the implicit solver needs the sum of all other forces";
}

TEST(ForceRows, LimitTheStepAsTheirPapersDo) {
    FluidParams p;
    p.forces.tension = 0.07F;
    p.forces.viscosity = "explicit";
    p.viscosity = 1.0e-3F;
    const float h = p.supportSpacings * p.spacing;
    const ForceLimitInputs inputs{p, h, false, 0.0F, 0.0F};
    const double hs = 0.5 * double{h};
    EXPECT_NEAR(forces().find("viscosity")->limit(inputs).dt, 0.125 * hs * hs / double{p.viscosity}, 1.0e-12) << "Morris et al. 1997";
    EXPECT_NEAR(forces().find("tension")->limit(inputs).dt, 0.25 * std::sqrt(1000 * hs * hs * hs / (2 * 3.14159265 * 0.07)), 1.0e-7)
        << "Brackbill et al. 1992";
    p.forces.viscosity = "implicit";
    EXPECT_GT(forces().find("viscosity")->limit(inputs).dt, 1.0e9) << "an implicit solver has no limit";
    p.viscosity = 0;
    EXPECT_NEAR(forces().find("viscosity")->limit({p, h, true, 0.0F, 1.0e-2F}).dt, 0.125 * hs * hs / 1.0e-3, 1.0e-6)
        << "a tenth of the artificial viscosity counts";
}

TEST(MethodRows, GiveTheirLeastSubsteps) {
    FluidParams p;
    p.pbf.minSubsteps = 3;
    p.dfsph.minSubsteps = 7;
    for (const auto& [name, least] : {std::pair("pbf", 3), std::pair("dfsph", 7), std::pair("wcsph", 1), std::pair("wcsph_thesis", 1)}) {
        p.method = name;
        EXPECT_EQ(methodOf(p).leastSubsteps(p), least) << name;
    }
}

}  // namespace
}  // namespace rivulet::rows_test
