extern "C" const int something_else = 1;
