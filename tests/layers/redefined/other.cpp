namespace csrbf {

struct Partition {
  double labels = 0;
};

}  // namespace csrbf
