#include "places.h"

std::string tree() { return GNOMON_SOURCE_DIR; }
std::string tree_file(const std::string& below_root) { return GNOMON_SOURCE_DIR "/" + below_root; }
std::string data_file(const std::string& below_data) { return GNOMON_TEST_DATA "/" + below_data; }
std::string tested_program() { return GNOMON_TEST_PROGRAM; }
std::string faults_plugin() { return GNOMON_TEST_FAULTS; }
std::string fake_card_library() { return GNOMON_TEST_FAKE_CARD; }
