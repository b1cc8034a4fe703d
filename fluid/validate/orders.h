// Order of convergence: the errors of a case at four spacings, and the power of the spacing that fits them.
#pragma once

#include <string>
#include <vector>

#include "fluid/validate/physics_case.h"

namespace rivulet {

struct OrderRow {
    std::string what;            // as Finding::what of the coarsest run
    std::vector<double> errors;  // one a spacing
    double order = 0;            // error ~ spacing^order, by least squares; NaN: an error is 0 or not a number
};
struct Orders {
    std::vector<double> spacings;  // m, from coarse to fine
    std::vector<OrderRow> rows;    // one a judged figure
    bool stopped = false;
};

// The slope of the line through the logarithms; NaN: a value is not above 0. At least two values each.
double orderOf(const std::vector<double>& spacings, const std::vector<double>& errors);

// Runs the case at PhysicsCase::sizes, which must not be empty. Settings beyond the sizes are those of `validate --quick`. Error: as
// PhysicsCase::run.
Result<Orders> measureOrders(const PhysicsCase& row, const CaseSettings& settings);

}  // namespace rivulet
