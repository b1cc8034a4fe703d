#include "fluid/voxel/labels.h"

namespace rivulet {

std::vector<uint8_t> reachableFromBorder(const VoxelGrid& surface) {
    std::vector<uint8_t> reached(surface.count(), 0);
    std::vector<ivec3> open;
    auto reach = [&](const ivec3& c) {
        if (!surface.contains(c) || surface.test(c) || reached[surface.index(c)] != 0) return;
        reached[surface.index(c)] = 1;
        open.push_back(c);
    };
    const ivec3 n = surface.size;
    for (int b = 0; b < n.z; ++b)
        for (int a = 0; a < n.y; ++a)
            for (int x : {0, n.x - 1}) reach({x, a, b});
    for (int b = 0; b < n.z; ++b)
        for (int a = 0; a < n.x; ++a)
            for (int y : {0, n.y - 1}) reach({a, y, b});
    for (int b = 0; b < n.y; ++b)
        for (int a = 0; a < n.x; ++a)
            for (int z : {0, n.z - 1}) reach({a, b, z});
    while (!open.empty()) {
        const ivec3 c = open.back();
        open.pop_back();
        for (const ivec3& step : {ivec3(1, 0, 0), ivec3(-1, 0, 0), ivec3(0, 1, 0), ivec3(0, -1, 0), ivec3(0, 0, 1), ivec3(0, 0, -1)})
            reach(ivec3(c.x + step.x, c.y + step.y, c.z + step.z));
    }
    return reached;
}

}  // namespace rivulet
