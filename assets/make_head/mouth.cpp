#include "assets/make_head/mouth.h"

#include <algorithm>
#include <cmath>

#include "assets/make_head/noise.h"

namespace rivulet::head {
namespace {

// A closed surface over a sphere's directions: `at` moves each.
template <class At>
void addBall(Part& part, uint32_t around, uint32_t rows, const At& at) {
    const auto first = static_cast<uint32_t>(part.positions.size());
    for (uint32_t j = 0; j <= rows; ++j)
        for (uint32_t i = 0; i <= around; ++i) {
            const double a = 2 * kPi * i / around, b = kPi * j / rows;
            part.positions.push_back(at(dvec3(std::sin(b) * std::cos(a), std::cos(b), std::sin(b) * std::sin(a))));
            part.uvs.emplace_back(static_cast<double>(i) / around, static_cast<double>(j) / rows);
        }
    for (uint32_t j = 0; j < rows; ++j)
        for (uint32_t i = 0; i < around; ++i) {
            const uint32_t p = first + j * (around + 1) + i, q = p + around + 1;
            part.triangles.push_back({p, p + 1, q + 1});
            part.triangles.push_back({p, q + 1, q});
        }
}

double signedPower(double x, double power) { return std::copysign(std::pow(std::abs(x), power), x); }

}  // namespace

Part makeTeeth(std::vector<double>& jaw) {
    Part part;
    part.name = "teeth";
    part.material = "teeth";
    // cm, from the middle outward: width, height of the crown; Wheeler's means.
    constexpr double kUpper[7][2] = {{0.85, 1.05}, {0.65, 0.90}, {0.76, 1.00}, {0.70, 0.85}, {0.66, 0.82}, {1.0, 0.75}, {0.95, 0.70}};
    constexpr double kLower[7][2] = {{0.52, 0.88}, {0.56, 0.92}, {0.68, 1.02}, {0.70, 0.85}, {0.71, 0.80}, {1.1, 0.75}, {1.0, 0.70}};
    for (const bool upper : {true, false}) {
        const double wide = upper ? 2.55 : 2.40, deep = upper ? 3.4 : 3.3, front = upper ? 5.15 : 4.95;
        for (const double side : {1.0, -1.0}) {
            double along = 0;  // of the arch, from its middle to this tooth's
            for (int k = 0; k < 7; ++k) {
                const double width = (upper ? kUpper : kLower)[k][0], height = (upper ? kUpper : kLower)[k][1];
                along += 0.5 * width;
                double angle = 0;  // on the ellipse x = wide sin, z = front - deep (1 - cos)
                for (double run = 0; run < along && angle < 1.6; angle += 0.01)
                    run += 0.01 * std::hypot(wide * std::cos(angle), deep * std::sin(angle));
                along += 0.5 * width;
                const dvec3 at(side * wide * std::sin(angle), 0, front - deep * (1 - std::cos(angle)));
                const dvec3 across = glm::normalize(dvec3(wide * std::cos(angle), 0, -side * deep * std::sin(angle)));
                const dvec3 out =
                    glm::normalize(glm::cross(across, dvec3(0, 1, 0)) * -1.0) * (glm::cross(across, dvec3(0, 1, 0)).z < 0 ? 1.0 : -1.0);
                const double edge = upper ? -4.36 : -4.78;  // where the rows nearly meet
                const double middle = edge + (upper ? 0.5 : -0.5) * height + 0.03 * (hash(k, upper ? 1 : 2, side > 0 ? 1 : 0, 5) - 0.5);
                const double thick = k < 3 ? 0.34 : 0.62;
                const size_t before = part.positions.size();
                addBall(part, 12, k < 5 ? 8 : 6, [&](dvec3 d) {
                    const double x = signedPower(d.x, 0.42), y = signedPower(d.y, 0.45), z = signedPower(d.z, 0.8);
                    const double biting = upper ? -y : y, neck = 1 - 0.22 * smoothstep(0.2, -1.0, biting);
                    // The cutting edge is thin, the neck thick.
                    const double body = thick * glm::mix(1.0, k < 3 ? 0.35 : 0.8, smoothstep(-0.4, 1.0, biting));
                    return dvec3(at.x, middle, at.z) + across * (0.515 * width * x * neck) + dvec3(0, 0.5 * height * y, 0) +
                           out * (body * z * 0.5 - 0.12 * (biting * biting));
                });
                for (size_t v = before; v < part.positions.size(); ++v) jaw.push_back(upper ? 0.0 : 1.0);
            }
        }
    }
    part.normals = normalsOf(part.positions, part.triangles);
    return part;
}

Part makeTongue(std::vector<double>& jaw) {
    Part part;
    part.name = "tongue";
    part.material = "tongue";
    addBall(part, 28, 20, [&](dvec3 d) {
        dvec3 p(1.55 * signedPower(d.x, 0.85), 0.48 * signedPower(d.y, 0.9), 2.3 * d.z);
        p.x *= 1 - 0.35 * smoothstep(0.2, 1.0, d.z);
        p.y -= 0.16 * std::exp(-p.x * p.x / 0.06) * smoothstep(0.0, 0.5, d.y);  // the furrow
        p.y += 0.03 * fractal(p * 3.0, 2, 301) + 0.22 * smoothstep(0.3, -1.0, d.z) - 0.15 * smoothstep(0.5, 1.0, d.z);
        return p + dvec3(0, -4.98, 2.35);
    });
    jaw.assign(part.positions.size(), 1.0);
    part.normals = normalsOf(part.positions, part.triangles);
    return part;
}

}  // namespace rivulet::head
