"""What the server lets in: requests, identities, uploads. Only this package touches the inside of viser."""
