offer(Object.entries(data.files || {}));
