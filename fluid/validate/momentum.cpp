// Two unequal drops collide off-centre without gravity: pair forces are equal, opposite and along the line between the particles.
#include <cmath>

#include "fluid/validate/trial.h"

namespace rivulet {

Result<Outcome> runMomentum(const CaseSettings& settings) {
    Result<Trial> trial = Trial::open("momentum", settings);
    if (!trial) return trial.error();
    struct Sum {
        dvec3 linear{0.0}, angular{0.0};
        double speeds = 0, levers = 0;
    };
    const auto sum = [&trial] {
        Sum s;
        const HostParticles all = trial->particles();
        for (size_t i = 0; i < all.position.size(); ++i) {
            const dvec3 x(all.position[i]), v(all.velocity[i]);
            s.linear += v;
            s.angular += glm::cross(x, v);
            s.speeds += glm::length(v);
            s.levers += glm::length(x) * glm::length(v);
        }
        return s;
    };
    const Sum before = sum();
    Curve linear{"momentum", true, {}}, angular{"angular momentum", true, {}};
    double worst = 0, worstTurn = 0;
    const bool done = trial->run(1.0 / 60, [&] {
        const Sum now = sum();
        const double a = glm::length(now.linear - before.linear) / before.speeds,
                     b = glm::length(now.angular - before.angular) / before.levers;
        worst = std::max(worst, a);
        worstTurn = std::max(worstTurn, b);
        linear.points.emplace_back(trial->time(), a);
        angular.points.emplace_back(trial->time(), b);
    });
    if (!done) return trial->outcome({}, {});
    return trial->outcome({{"momentum, drift over sum m|v|", "", worst, 0, worst, 1.0e-5},
                           {"angular momentum, drift over sum m|x||v|", "", worstTurn, 0, worstTurn, 1.0e-5}},
                          {"Drift of momentum", "time, s", "share of sum m|v|, sum m|x||v|", {linear, angular}});
}

}  // namespace rivulet
