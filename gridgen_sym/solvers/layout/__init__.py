"""Problems on several blocks that are one grid: every block has its own nodes, and the copies of a node move as one."""
