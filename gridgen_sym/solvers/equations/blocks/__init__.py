"""The equations on several blocks as one system."""
