#include "fluid/validate/orders.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "engine/core/assert.h"
#include "fluid/session/chart_table.h"

namespace rivulet {

double orderOf(const std::vector<double>& spacings, const std::vector<double>& errors) {
    double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
    for (size_t i = 0; i < spacings.size(); ++i) {
        if (!(errors[i] > 0)) return std::numeric_limits<double>::quiet_NaN();
        const double x = std::log(spacings[i]), y = std::log(errors[i]);
        n += 1;
        sx += x;
        sy += y;
        sxx += x * x;
        sxy += x * y;
    }
    return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

Result<Orders> measureOrders(const PhysicsCase& row, const CaseSettings& settings) {
    std::vector<std::string_view> sizes;
    const std::string_view all = row.sizes;
    for (size_t at = 0; at < all.size();) {
        const size_t end = std::min(all.find(" | ", at), all.size());
        sizes.push_back(all.substr(at, end - at));
        at = end + 3;
    }
    ASSERT(!sizes.empty(), "a case of orders has sizes");
    Orders orders;
    for (size_t k = 0; k < sizes.size(); ++k) {
        CaseSettings with = settings;
        with.quick = true;
        const std::vector<std::string> size = assignmentsOf(sizes[k]);
        with.assignments.insert(with.assignments.begin(), size.begin(), size.end());
        with.goOn = [&](double share) { return settings.goOn((static_cast<double>(k) + share) / static_cast<double>(sizes.size())); };
        const Result<Outcome> outcome = runCase(row, with);
        if (!outcome) return outcome.error();
        if (outcome->findings.empty()) {
            orders.stopped = true;
            return orders;
        }
        orders.spacings.push_back(outcome->spacing);
        size_t judged = 0;
        for (const Finding& f : outcome->findings) {
            if (!f.tolerance) continue;
            if (k == 0) orders.rows.push_back({f.what, {}, 0});
            orders.rows[judged++].errors.push_back(f.error);
        }
    }
    for (OrderRow& r : orders.rows) r.order = orderOf(orders.spacings, r.errors);
    return orders;
}

}  // namespace rivulet
