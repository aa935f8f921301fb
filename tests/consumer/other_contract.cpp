extern "C" const int gnomon_plugin_abi = 999;
