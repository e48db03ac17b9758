// The packaged peers that `make bench-cone` runs beside our methods, on the same points.

extern "C" {
#include "bench/methods.h"
#include "sphere/cone.h"
}

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Min_sphere_of_spheres_d.h>
#include <CGAL/Min_sphere_of_spheres_d_traits_3.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/convex_hull_2.h>

#include <cmath>
#include <iterator>
#include <vector>

namespace {
using Sphere_kernel = CGAL::Simple_cartesian<double>;
using Sphere_traits = CGAL::Min_sphere_of_spheres_d_traits_3<Sphere_kernel, double>;
using Min_sphere = CGAL::Min_sphere_of_spheres_d<Sphere_traits>;
using Plane_kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

std::vector<Sphere_traits::Sphere> spheres;
std::vector<Plane_kernel::Point_2> on_plane;
std::vector<Plane_kernel::Point_2> hull;

double q30(int32_t a) {
    return a * 0x1p-30;
}

Sphere_kernel::Point_3 unit(struct vec3 p) {
    const double x = p.x, y = p.y, z = p.z, length = std::sqrt(x * x + y * y + z * z);
    return {x / length, y / length, z / length};
}
} // namespace

// The least sphere of the unit vectors is centred on the cone's axis.
extern "C" void peer_sphere_prepare(const struct vec3 *points, uint32_t count) {
    spheres.clear();
    for (uint32_t i = 0; i < count; i++) {
        spheres.emplace_back(unit(points[i]), 0.0);
    }
}

extern "C" void peer_sphere_run(const struct vec3 *, uint32_t, struct bench_run *run) {
    Min_sphere least(spheres.begin(), spheres.end());
    auto centre = least.center_cartesian_begin();
    const double x = *centre++, y = *centre++, z = *centre;
    const double length = std::sqrt(x * x + y * y + z * z);
    run->axis_q30 = {static_cast<int32_t>(std::lround(x / length * 0x1p30)),
                     static_cast<int32_t>(std::lround(y / length * 0x1p30)),
                     static_cast<int32_t>(std::lround(z / length * 0x1p30))};
}

// On the gnomonic plane about the axis, great circles are lines, and the hull is the plane's.
extern "C" void peer_hull_prepare(const struct vec3 *points, uint32_t count) {
    struct bench_run run = {};
    bench_methods[BENCH_PIVOT].prepare(points, count);
    bench_methods[BENCH_PIVOT].run(points, count, &run);
    const double ax = q30(run.axis_q30.x), ay = q30(run.axis_q30.y), az = q30(run.axis_q30.z);
    // Two directions across the axis.
    const bool steep = std::fabs(az) > 0.5;
    double rx = steep ? -az : -ay, ry = steep ? 0.0 : ax, rz = steep ? ax : 0.0;
    const double r = std::sqrt(rx * rx + ry * ry + rz * rz);
    rx /= r, ry /= r, rz /= r;
    const double ux = ay * rz - az * ry, uy = az * rx - ax * rz, uz = ax * ry - ay * rx;
    on_plane.clear();
    for (uint32_t i = 0; i < count; i++) {
        const double x = q30(points[i].x), y = q30(points[i].y), z = q30(points[i].z);
        const double depth = ax * x + ay * y + az * z;
        on_plane.emplace_back((rx * x + ry * y + rz * z) / depth,
                              (ux * x + uy * y + uz * z) / depth);
    }
}

extern "C" void peer_hull_run(const struct vec3 *, uint32_t, struct bench_run *run) {
    hull.clear();
    CGAL::convex_hull_2(on_plane.begin(), on_plane.end(), std::back_inserter(hull));
    run->hull_size = static_cast<uint32_t>(hull.size());
}
