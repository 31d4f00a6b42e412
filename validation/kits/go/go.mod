module marchingcubes

go 1.21
