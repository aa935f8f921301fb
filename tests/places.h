#pragma once
#include <string>

// Paths that the build gives to tests. Only places.cpp is compiled with them, so that a tree elsewhere compiles the same tests.

/// The top of the tree, and a file below it: tree_file("docs/viewer.md").
std::string tree();
std::string tree_file(const std::string& below_root);
/// A file of tests/data.
std::string data_file(const std::string& below_data);
/// The program `gnomon` that was built with these tests.
std::string tested_program();
/// The plugin of tests/faults.
std::string faults_plugin();
/// A library that stands for that of a graphics card's maker.
std::string fake_card_library();
