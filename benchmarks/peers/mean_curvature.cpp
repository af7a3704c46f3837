// Skeleton of a closed triangle mesh by CGAL's mean-curvature flow: mean_curvature IN.off OUT.txt
// OUT holds the number of points and of edges, then x y z of each point, then the two points of each edge.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/extract_mean_curvature_flow_skeleton.h>

#include <boost/graph/graph_traits.hpp>
#include <fstream>
#include <iomanip>
#include <iostream>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Flow = CGAL::Mean_curvature_flow_skeletonization<Mesh>;

int main(int count, char** words) {
  if (count != 3) return 2;
  std::ifstream in(words[1]);
  Mesh mesh;
  if (!(in >> mesh) || !CGAL::is_triangle_mesh(mesh) || !CGAL::is_closed(mesh)) {
    std::cerr << "expected a closed triangle mesh\n";
    return 3;
  }
  Flow::Skeleton skeleton;
  CGAL::extract_mean_curvature_flow_skeleton(mesh, skeleton);
  std::ofstream out(words[2]);
  out << std::setprecision(17) << boost::num_vertices(skeleton) << ' ' << boost::num_edges(skeleton) << '\n';
  for (auto node : CGAL::make_range(boost::vertices(skeleton))) out << skeleton[node].point << '\n';
  for (auto edge : CGAL::make_range(boost::edges(skeleton)))
    out << boost::source(edge, skeleton) << ' ' << boost::target(edge, skeleton) << '\n';
  return out ? 0 : 4;
}
