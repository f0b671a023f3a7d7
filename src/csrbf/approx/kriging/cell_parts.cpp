#include "csrbf/approx/kriging/cell_parts.hpp"

namespace csrbf {

template <int Dim>
typename Cover<Dim>::Tree tree_of_parts(const typename Cover<Dim>::Tree& old, const CellParts<Dim>& parts,
                                        std::vector<PlacedPart<Dim>>& leaves) {
  typename Cover<Dim>::Tree tree;
  tree.box = old.box;
  tree.growth = old.growth;
  std::vector<std::uint32_t> place(old.axis.size());  // of the old nodes
  for (std::size_t i = 0; i < old.axis.size(); ++i) {
    place[i] = static_cast<std::uint32_t>(tree.axis.size());
    if (old.axis[i] >= 0) {
      tree.axis.push_back(old.axis[i]);
      tree.split.push_back(old.split[i]);
      tree.right.push_back(old.right[i]);
      continue;
    }
    const std::size_t first = tree.axis.size();
    for (const CellPart<Dim>& part : parts[old.right[i]]) {
      tree.axis.push_back(part.axis);
      tree.split.push_back(part.split);
      tree.right.push_back(static_cast<std::uint32_t>(part.axis >= 0 ? first + part.right : leaves.size()));
      if (part.axis < 0) leaves.emplace_back(old.right[i], &part);
    }
  }
  for (std::size_t i = 0; i < old.axis.size(); ++i)
    if (old.axis[i] >= 0) tree.right[place[i]] = place[old.right[i]];
  return tree;
}

#define CSRBF_INSTANTIATE(Dim)                                                                                   \
  template typename Cover<Dim>::Tree tree_of_parts<Dim>(const typename Cover<Dim>::Tree&, const CellParts<Dim>&, \
                                                        std::vector<PlacedPart<Dim>>&);
CSRBF_INSTANTIATE(1)
CSRBF_INSTANTIATE(2)
CSRBF_INSTANTIATE(3)
#undef CSRBF_INSTANTIATE

}  // namespace csrbf
